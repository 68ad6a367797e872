'use strict';
// What the terms of the page mean: their tooltips.

const TERMS = {
  'object': 'what is pushed',
  'robot': 'shape and drive of the robot',
  'base': 'how the base obeys: late, in steps, not slowly. The robot is not informed',
  'sensors': 'how the robot knows where the object is: motion capture, or a camera',
  'law': 'how the robot steers in a push that holds one contact',
  'position error [mm]': 'distance of the object from its goal; dashed: what is allowed',
  'heading error [°]': 'angle between object and goal; dashed: what is allowed',
  'contact force from the normal [°]': 'direction of the force; beyond the dashed lines, the friction cone, the contact slips',
  'object to goal': 'distance and angle that remain',
  'gap between robot and object': 'zero while they touch',
  'contact force': 'of the robot on the object',
  'speed of the robot': 'over the floor',
  'pushes so far': 'in this run',
  'believed minus true object': 'how far off the robot takes the object to be',
  'known to (standard deviation)': 'how well the robot claims to know position and heading of the object',
  'stated chance': 'to end within tolerance, as the last plan states it',
  'time left, as stated': 'median, and what 95 of 100 such tasks keep to, from the last plan on',
  'error at the end, as stated': 'distance from the goal: median, and what 95 of 100 such tasks keep to',
  'object seen': 'whether the camera sees it now',
  'believed minus true centre of friction': 'how far off the robot takes the centre of friction to be',
  'true': 'in the simulation; the robot is not informed',
  'nominal': 'what the robot was told',
  'believed': 'what the robot has learned from its pushes',
  'stated': 'what the robot was told of its base',
  'learned': 'what the robot has learned of its base',
  'foot': 'a place where the object stands on the floor: its friction there',
  'contact': 'friction between robot and object',
  'dead time': 'time from a command to the first motion',
  'least speed': 'slower commands do not move the base',
  'least yaw rate': 'slower rotations do not happen',
  'pulse': 'length of a short command by which the robot moves less than its least speed allows',
  'acceleration': 'by which the base changes its speed at most',
  'yaw acceleration': 'by which the base changes its yaw rate at most',
  'gain of the left wheel': 'its speed over what is commanded',
  'gain of the right wheel': 'its speed over what is commanded',
  'gain of the translation': 'speed of the base over what is commanded',
  'gain of the rotation': 'yaw rate of the base over what is commanded',
  'deviation of gains': 'standard deviation of both gains as they were learned',
  'noise of poses': 'random error of each measured position of the object',
  'noise of headings': 'random error of each measured heading of the object',
  'latency of poses': 'age of a pose when the robot gets it',
  'lost poses': 'part of the measured poses that never come',
  'error of distances': 'by which odometry measures distances too long',
  'error of rotations': 'by which odometry measures rotations too large',
  'drift of the heading': 'by which odometry rotates for each metre driven',
  'friction cone': 'a force in it lets the contact hold',
  'true centre of friction': 'a push through it moves the object without rotation',
};

// Give an element the tooltip of its term; units, numbers and what follows a comma belong to none.
function explain(element, name) {
  const known = [name, name.replace(/ \[.*\]$/, ''), name.replace(/ (\d|\(|,).*$/, '')].find((term) => term in TERMS);
  if (known) element.title = TERMS[known];
  return element;
}

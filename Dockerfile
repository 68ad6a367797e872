# Planner, controller and simulator on ROS 2 Jazzy; see docs/ros2.md.
FROM ros:jazzy-ros-base

# The Python of the image serves nothing else, so that pip may add casadi to it.
ENV PIP_BREAK_SYSTEM_PACKAGES=1 PIP_NO_CACHE_DIR=1
WORKDIR /ws

# Dependencies first: they are installed anew only when a manifest changes.
COPY package.xml src/push_control/package.xml
COPY push_control_msgs/package.xml src/push_control_msgs/package.xml
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3-pip \
    && pip install 'casadi>=3.7.0' \
    && rosdep update --rosdistro jazzy \
    && rosdep install --from-paths src --ignore-src -y \
        -t buildtool -t buildtool_export -t build -t build_export -t exec \
    && rm -rf /var/lib/apt/lists/* src

COPY . src/push_control
RUN ln -s push_control/push_control_msgs src/push_control_msgs \
    && . /opt/ros/jazzy/setup.sh \
    && colcon build

ENTRYPOINT ["/bin/bash", "-c", "source /ws/install/setup.bash && exec \"$@\"", "--"]
CMD ["ros2", "launch", "push_control", "robot_launch.py"]

#ifndef PUSH_CONTROL_NAV2__PUSH_OBJECT_ACTION_HPP_
#define PUSH_CONTROL_NAV2__PUSH_OBJECT_ACTION_HPP_

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "behaviortree_cpp/behavior_tree.h"
#include "geometry_msgs/msg/pose_stamped.hpp"
#include "nav2_behavior_tree/bt_action_node.hpp"
#include "push_control_msgs/action/push_object.hpp"

namespace push_control_nav2
{

/**
 * @brief Pushes an object to its goal pose; a client of the action push_object.
 *
 * It succeeds when the object is at its goal, and fails when the push ends otherwise or its goal
 * cannot be sent. Ports have the names, units and frames of the fields of the action, but times
 * are seconds. Outputs are written at the end; until then error_code_id is UNKNOWN.
 *
 * @code
 * <PushObject goal_pose="{crate_goal}" time_limit="120" error_code_id="{push_error_code}"/>
 * @endcode
 */
class PushObjectAction
  : public nav2_behavior_tree::BtActionNode<push_control_msgs::action::PushObject>
{
public:
  using Action = push_control_msgs::action::PushObject;
  using Result = Action::Result;

  /**
   * @brief Connect to the server of the action
   * @param xml_tag_name name of the node in the tree
   * @param action_name name of the action, unless the port server_name has another one
   * @param conf of the node; its blackboard is that of Nav2
   * @throws std::runtime_error if the server is not there within wait_for_service_timeout
   */
  PushObjectAction(
    const std::string & xml_tag_name,
    const std::string & action_name,
    const BT::NodeConfiguration & conf);

  /// @brief Read the goal from the ports; a goal that cannot be read is not sent.
  void on_tick() override;

  /// @brief Write the result of a push whose object is at its goal.
  BT::NodeStatus on_success() override;

  /// @brief Write the result of a push that has failed.
  BT::NodeStatus on_aborted() override;

  /// @brief Write the result of a push that somebody else has cancelled: it has not succeeded.
  BT::NodeStatus on_cancelled() override;

  /// @brief List the ports: those of all action nodes of Nav2, goal and result.
  static BT::PortsList providedPorts()
  {
    return providedBasicPorts(
      {
        BT::InputPort<std::chrono::milliseconds>(
          "cancel_timeout", "How long halting waits for the robot to back off [ms]"),
        BT::InputPort<geometry_msgs::msg::PoseStamped>("goal_pose", "Goal pose of the object"),
        BT::InputPort<std::string>(
          "object_name", std::string(), "Name of the object; empty: the present one"),
        BT::InputPort<double>(
          "position_tolerance", 0.0, "Distance at which the goal is reached [m]; 0: as configured"),
        BT::InputPort<double>(
          "heading_tolerance", 0.0, "Heading error at which it is reached [rad]; 0: as configured"),
        BT::InputPort<double>(
          "time_limit", 0.0, "Time after which the goal is given up [s]; 0: none"),
        BT::OutputPort<uint16_t>("error_code_id", "Error code of the action; 0: none"),
        BT::OutputPort<std::string>("error_msg", "One sentence on it"),
        BT::OutputPort<std::vector<std::string>>("codes", "Cause codes"),
        BT::OutputPort<double>("position_error", "Distance of the object from its goal [m]"),
        BT::OutputPort<double>("heading_error", "Object heading minus that of the goal [rad]"),
        BT::OutputPort<double>(
          "position_deviation", "Standard deviation of the position in the goal's frame [m]"),
        BT::OutputPort<double>("heading_deviation", "Standard deviation of the heading [rad]"),
        BT::OutputPort<uint16_t>("pushes", "Number of pushes begun"),
        BT::OutputPort<double>("duration", "Time from the first measurement to the end [s]"),
      });
  }

private:
  /// @brief Fill goal_; false if a port has no value or one of another type.
  bool read_goal();

  /// @brief Write error_code_id and error_msg.
  void write_error(uint16_t code, const std::string & message);

  /// @brief Write all outputs from the result.
  void write_result();
};

}  // namespace push_control_nav2

#endif  // PUSH_CONTROL_NAV2__PUSH_OBJECT_ACTION_HPP_

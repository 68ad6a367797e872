#include "push_control_nav2/push_object_action.hpp"

#include <cmath>
#include <memory>
#include <string>

#include "behaviortree_cpp/bt_factory.h"
#include "builtin_interfaces/msg/duration.hpp"

namespace push_control_nav2
{

namespace
{

constexpr double NANOSECONDS = 1e9;
// The greatest time that a Duration holds [s].
constexpr double MAX_DURATION = 2147483647.0;

bool is_duration(double seconds)
{
  return seconds >= 0.0 && seconds <= MAX_DURATION;
}

builtin_interfaces::msg::Duration to_duration(double seconds)
{
  builtin_interfaces::msg::Duration duration;
  const double whole = std::floor(seconds);
  duration.sec = static_cast<int32_t>(whole);
  duration.nanosec = static_cast<uint32_t>((seconds - whole) * NANOSECONDS);
  return duration;
}

double to_seconds(const builtin_interfaces::msg::Duration & duration)
{
  return duration.sec + duration.nanosec / NANOSECONDS;
}

}  // namespace

PushObjectAction::PushObjectAction(
  const std::string & xml_tag_name,
  const std::string & action_name,
  const BT::NodeConfiguration & conf)
: BtActionNode<Action>(xml_tag_name, action_name, conf)
{
}

void PushObjectAction::on_tick()
{
  if (read_goal()) {
    // Nav2 of Jazzy writes no code where a goal is rejected: that of a former push must not stay.
    write_error(Result::UNKNOWN, "the goal was not accepted, or has not ended");
  } else {
    should_send_goal_ = false;
    write_error(Result::INVALID_GOAL, "a port of PushObject has no value that can be used");
    RCLCPP_ERROR(
      node_->get_logger(), "%s: a port has no value that can be used", name().c_str());
  }
}

BT::NodeStatus PushObjectAction::on_success()
{
  write_result();
  return BT::NodeStatus::SUCCESS;
}

BT::NodeStatus PushObjectAction::on_aborted()
{
  write_result();
  return BT::NodeStatus::FAILURE;
}

BT::NodeStatus PushObjectAction::on_cancelled()
{
  // Halting calls this, too, without a result where the robot still backs off.
  if (result_.result) {
    write_result();
  }
  // The action has no code for it, and 0 tells trees that the object is at its goal.
  write_error(Result::UNKNOWN, "the push was cancelled");
  return BT::NodeStatus::FAILURE;
}

bool PushObjectAction::read_goal()
{
  double position_tolerance{}, heading_tolerance{}, time_limit{};
  const bool is_read =
    getInput("goal_pose", goal_.goal_pose) &&
    getInput("object_name", goal_.object_name) &&
    getInput("position_tolerance", position_tolerance) &&
    getInput("heading_tolerance", heading_tolerance) &&
    getInput("time_limit", time_limit) && is_duration(time_limit);
  if (is_read) {
    goal_.position_tolerance = static_cast<float>(position_tolerance);
    goal_.heading_tolerance = static_cast<float>(heading_tolerance);
    goal_.time_limit = to_duration(time_limit);
  }
  return is_read;
}

void PushObjectAction::write_error(uint16_t code, const std::string & message)
{
  setOutput("error_code_id", code);
  setOutput("error_msg", message);
}

void PushObjectAction::write_result()
{
  const Result & result = *result_.result;
  write_error(result.error_code, result.error_msg);
  setOutput("codes", result.codes);
  setOutput("position_error", static_cast<double>(result.position_error));
  setOutput("heading_error", static_cast<double>(result.heading_error));
  setOutput("position_deviation", static_cast<double>(result.position_deviation));
  setOutput("heading_deviation", static_cast<double>(result.heading_deviation));
  setOutput("pushes", result.pushes);
  setOutput("duration", to_seconds(result.duration));
}

}  // namespace push_control_nav2

BT_REGISTER_NODES(factory)
{
  BT::NodeBuilder builder =
    [](const std::string & name, const BT::NodeConfiguration & config)
    {
      return std::make_unique<push_control_nav2::PushObjectAction>(name, "push_object", config);
    };
  factory.registerBuilder<push_control_nav2::PushObjectAction>("PushObject", builder);
}

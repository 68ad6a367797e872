// The node PushObject in a tree, with a server of its action in the same process.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "behaviortree_cpp/bt_factory.h"
#include "push_control_nav2/push_object_action.hpp"
#include "rclcpp/rclcpp.hpp"
#include "rclcpp_action/rclcpp_action.hpp"

#if __has_include("nav2_ros_common/lifecycle_node.hpp")
#include "nav2_ros_common/lifecycle_node.hpp"
using TreeNode = nav2::LifecycleNode;  // Nav2 from Kilted on
#else
using TreeNode = rclcpp::Node;
#endif

using namespace std::chrono_literals;
using PushObject = push_control_msgs::action::PushObject;
using GoalHandle = rclcpp_action::ServerGoalHandle<PushObject>;

namespace
{

constexpr auto TIMEOUT = 10s;

// Answers each goal with `result`, as reached where that has no error; or waits for a cancel.
class PushServer : public rclcpp::Node
{
public:
  PushServer()
  : Node("push_server")
  {
    server_ = rclcpp_action::create_server<PushObject>(
      this, "push_object",
      [this](const rclcpp_action::GoalUUID &, std::shared_ptr<const PushObject::Goal> goal) {
        this->goal = *goal;
        has_goal = true;
        return is_rejecting ?
               rclcpp_action::GoalResponse::REJECT :
               rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
      },
      [](const std::shared_ptr<GoalHandle>) {return rclcpp_action::CancelResponse::ACCEPT;},
      [this](const std::shared_ptr<GoalHandle> handle) {
        handle_ = handle;
        timer_ = create_wall_timer(1ms, [this]() {this->answer();});
      });
  }

  std::atomic<bool> is_rejecting{false};
  std::atomic<bool> is_waiting{false};
  std::atomic<bool> has_goal{false};
  std::atomic<bool> was_cancelled{false};
  PushObject::Goal goal;
  PushObject::Result result;

private:
  void answer()
  {
    const auto answer = std::make_shared<PushObject::Result>(result);
    if (handle_->is_canceling()) {
      was_cancelled = true;
      handle_->canceled(answer);
    } else if (is_waiting) {
      return;
    } else if (result.error_code == PushObject::Result::NONE) {
      handle_->succeed(answer);
    } else {
      handle_->abort(answer);
    }
    timer_->cancel();
  }

  rclcpp_action::Server<PushObject>::SharedPtr server_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::shared_ptr<GoalHandle> handle_;
};

class PushObjectTest : public ::testing::Test
{
protected:
  void SetUp() override
  {
    server = std::make_shared<PushServer>();
    executor.add_node(server);
    thread = std::thread([this]() {executor.spin();});
    node = std::make_shared<TreeNode>("push_object_test");
    blackboard = BT::Blackboard::create();
    blackboard->set<TreeNode::SharedPtr>("node", node);
    for (const auto * name : {"server_timeout", "cancel_timeout", "wait_for_service_timeout"}) {
      blackboard->set<std::chrono::milliseconds>(name, TIMEOUT);
    }
    blackboard->set<std::chrono::milliseconds>("bt_loop_duration", 10ms);
    factory.registerBuilder<push_control_nav2::PushObjectAction>(
      "PushObject",
      [](const std::string & name, const BT::NodeConfiguration & config) {
        return std::make_unique<push_control_nav2::PushObjectAction>(name, "push_object", config);
      });
  }

  void TearDown() override
  {
    executor.cancel();
    thread.join();
  }

  BT::Tree tree(const std::string & ports)
  {
    const std::string xml =
      "<root BTCPP_format=\"4\"><BehaviorTree ID=\"Push\"><PushObject error_code_id=\"{code}\" "
      "error_msg=\"{message}\" codes=\"{codes}\" position_error=\"{error}\" pushes=\"{pushes}\" "
      "position_deviation=\"{deviation}\" duration=\"{duration}\" " + ports +
      "/></BehaviorTree></root>";
    return factory.createTreeFromText(xml, blackboard);
  }

  static BT::NodeStatus run(BT::Tree & tree)
  {
    const auto end = std::chrono::steady_clock::now() + TIMEOUT;
    auto status = tree.tickOnce();
    while (status == BT::NodeStatus::RUNNING && std::chrono::steady_clock::now() < end) {
      status = tree.tickOnce();
    }
    return status;
  }

  std::shared_ptr<PushServer> server;
  rclcpp::executors::SingleThreadedExecutor executor;
  std::thread thread;
  TreeNode::SharedPtr node;
  BT::Blackboard::Ptr blackboard;
  BT::BehaviorTreeFactory factory;
};

constexpr char POSE[] = "goal_pose=\"0;map;1.0;0.5;0.0;0.0;0.0;0.0;1.0\" ";

TEST_F(PushObjectTest, sends_every_port_as_a_field_of_the_goal)
{
  auto push = tree(
    std::string(POSE) + "object_name=\"crate\" position_tolerance=\"0.02\" "
    "heading_tolerance=\"0.05\" time_limit=\"90.5\"");
  EXPECT_EQ(run(push), BT::NodeStatus::SUCCESS);
  EXPECT_EQ(server->goal.goal_pose.header.frame_id, "map");
  EXPECT_EQ(server->goal.goal_pose.pose.position.y, 0.5);
  EXPECT_EQ(server->goal.object_name, "crate");
  EXPECT_FLOAT_EQ(server->goal.position_tolerance, 0.02f);
  EXPECT_FLOAT_EQ(server->goal.heading_tolerance, 0.05f);
  EXPECT_EQ(server->goal.time_limit.sec, 90);
  EXPECT_EQ(server->goal.time_limit.nanosec, 500000000u);
}

TEST_F(PushObjectTest, leaves_to_the_controller_what_has_no_port)
{
  auto push = tree(POSE);
  EXPECT_EQ(run(push), BT::NodeStatus::SUCCESS);
  EXPECT_EQ(server->goal.object_name, "");
  EXPECT_EQ(server->goal.position_tolerance, 0.0f);
  EXPECT_EQ(server->goal.time_limit.sec, 0);
}

TEST_F(PushObjectTest, fails_with_the_code_and_the_numbers_of_the_result)
{
  server->result.error_code = PushObject::Result::NO_VALID_PLAN;
  server->result.error_msg = "no way";
  server->result.codes = {"TaskEvent.NO_PLAN", "PlanFailure.BLOCKED"};
  server->result.position_error = 0.25f;
  server->result.position_deviation = std::nanf("");
  server->result.pushes = 3;
  server->result.duration.sec = 2;
  server->result.duration.nanosec = 250000000;
  auto push = tree(POSE);
  EXPECT_EQ(run(push), BT::NodeStatus::FAILURE);
  EXPECT_EQ(blackboard->get<uint16_t>("code"), PushObject::Result::NO_VALID_PLAN);
  EXPECT_EQ(blackboard->get<std::string>("message"), "no way");
  EXPECT_EQ(blackboard->get<std::vector<std::string>>("codes"), server->result.codes);
  EXPECT_EQ(blackboard->get<double>("error"), 0.25);
  EXPECT_TRUE(std::isnan(blackboard->get<double>("deviation")));
  EXPECT_EQ(blackboard->get<uint16_t>("pushes"), 3);
  EXPECT_EQ(blackboard->get<double>("duration"), 2.25);
}

TEST_F(PushObjectTest, sends_no_goal_that_it_cannot_read)
{
  for (const std::string & ports : {
      std::string(), std::string(POSE) + "time_limit=\"-1\"",
      std::string(POSE) + "position_tolerance=\"{nothing}\""})
  {
    auto push = tree(ports);
    EXPECT_EQ(run(push), BT::NodeStatus::FAILURE) << ports;
    EXPECT_EQ(blackboard->get<uint16_t>("code"), PushObject::Result::INVALID_GOAL) << ports;
  }
  EXPECT_EQ(server->goal.goal_pose.header.frame_id, "");
}

TEST_F(PushObjectTest, keeps_no_code_of_a_former_push)
{
  server->result.error_code = PushObject::Result::NO_VALID_PLAN;
  auto push = tree(POSE);
  EXPECT_EQ(run(push), BT::NodeStatus::FAILURE);
  server->is_rejecting = true;
  EXPECT_EQ(run(push), BT::NodeStatus::FAILURE);
  EXPECT_EQ(blackboard->get<uint16_t>("code"), PushObject::Result::UNKNOWN);
}

TEST_F(PushObjectTest, cancels_when_halted)
{
  server->is_waiting = true;
  auto push = tree(POSE);
  const auto end = std::chrono::steady_clock::now() + TIMEOUT;
  while (!server->has_goal && std::chrono::steady_clock::now() < end) {
    EXPECT_EQ(push.tickOnce(), BT::NodeStatus::RUNNING);
  }
  // The node cancels what it knows to be accepted: each tick waits for the answer.
  for (int tick = 0; tick < 100; ++tick) {
    EXPECT_EQ(push.tickOnce(), BT::NodeStatus::RUNNING);
  }
  push.haltTree();
  EXPECT_TRUE(server->was_cancelled);
  EXPECT_EQ(blackboard->get<uint16_t>("code"), PushObject::Result::UNKNOWN);
}

}  // namespace

int main(int argc, char ** argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  rclcpp::init(argc, argv);
  const int status = RUN_ALL_TESTS();
  rclcpp::shutdown();
  return status;
}

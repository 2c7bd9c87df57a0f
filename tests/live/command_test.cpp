// Tests how commands of a page are read: what they say, and what is refused, with the key and what it may have.
#include <gtest/gtest.h>

#include "base/error.h"
#include "live/command.h"

namespace supple {
namespace command_test {

std::string refusal(const std::string& json) {
  try {
    (void)read_command(json);
    return "";
  } catch (const InputError& error) {
    return error.problems().front().message;
  }
}

TEST(LiveCommand, SaysWhatThePageAsksFor) {
  const Command set = read_command(R"({"do":"set","path":"body.bunny.material.mu","value":"2e5","over":0.5})");
  EXPECT_EQ(set.kind, CommandKind::set);
  EXPECT_EQ(set.path, "body.bunny.material.mu");
  EXPECT_EQ(set.value, "2e5");
  EXPECT_EQ(set.over, 0.5);
  EXPECT_EQ(read_command(R"({"do":"go","frame":45})").frame, 45);
  EXPECT_EQ(read_command(R"({"do":"grab","x":0.25,"y":0.75})").at, Eigen::Vector2d(0.25, 0.75));
  EXPECT_EQ(read_command(R"({"do":"orbit","by":[10,-5]})").at, Eigen::Vector2d(10, -5));
  EXPECT_FALSE(read_command(R"({"do":"drop"})").on);
  EXPECT_TRUE(read_command(R"({"do":"drop","pin":true})").on);
  const Command show = read_command(R"({"do":"show","field":"stretch","marks":false})");
  EXPECT_EQ(show.field, "stretch");
  EXPECT_EQ(show.marks, false);
  EXPECT_FALSE(show.wireframe);
}

TEST(LiveCommand, EveryKindCanBeRead) {
  const std::map<std::string, std::string> keys = {{"set", R"(,"path":"gravity","value":"[0,0,0]")"},
                                                   {"speed", R"(,"factor":1)"},
                                                   {"go", R"(,"frame":0)"},
                                                   {"grab", R"(,"x":0,"y":0)"},
                                                   {"drag", R"(,"x":0,"y":0)"},
                                                   {"release", R"(,"body":"b","name":"h")"},
                                                   {"orbit", R"(,"by":[0,0])"},
                                                   {"pan", R"(,"by":[0,0])"},
                                                   {"zoom", R"(,"by":1)"},
                                                   {"keep_rate", R"(,"on":true)"}};
  for (const std::string& name : all_names<CommandKind>()) {
    const auto more = keys.find(name);
    const std::string json = "{\"do\":\"" + name + "\"" + (more == keys.end() ? "" : more->second) + "}";
    EXPECT_EQ(name_of(read_command(json).kind), name);
  }
}

TEST(LiveCommand, WhatIsWrongIsNamed) {
  EXPECT_EQ(refusal("nonsense"), "wants a JSON object");
  EXPECT_EQ(refusal("[1]"), "wants a JSON object");
  EXPECT_EQ(refusal("{}"), "do: is missing");
  EXPECT_TRUE(refusal(R"({"do":"dance"})").starts_with("do: wants set, pause"));
  EXPECT_EQ(refusal(R"({"do":7})"), "do: wants a text of at most 200 characters");
  EXPECT_EQ(refusal(R"({"do":"set","path":"gravity"})"), "value: is missing");
  EXPECT_EQ(refusal(R"({"do":"set","path":"gravity","value":3})"), "value: wants a text of at most 3000 characters");
  EXPECT_EQ(refusal(R"({"do":"speed","factor":5})"), "factor: wants a number, 0.05 to 4");
  EXPECT_EQ(refusal(R"({"do":"speed","factor":null})"), "factor: wants a number, 0.05 to 4");
  EXPECT_EQ(refusal(R"({"do":"go","frame":1.5})"), "frame: wants a whole number");
  EXPECT_EQ(refusal(R"({"do":"go","frame":-1})"), "frame: wants a number, 0 to 1e+06");
  EXPECT_EQ(refusal(R"({"do":"go","frame":1e300})"), "frame: wants a number, 0 to 1e+06");
  EXPECT_EQ(refusal(R"({"do":"orbit","by":[1]})"), "by: wants two numbers, each -360 to 360");
  EXPECT_EQ(refusal(R"({"do":"orbit","by":[1,"2"]})"), "by: wants two numbers, each -360 to 360");
  EXPECT_EQ(refusal(R"({"do":"pause","frame":3})"), "frame: this command has no such key");
  EXPECT_TRUE(refusal(R"({"do":"show","field":"beauty"})").starts_with("field: wants none, stretch"));
  EXPECT_EQ(refusal(R"({"do":"keep_rate","on":1})"), "on: wants true or false");
}

TEST(LiveCommand, DeepTextsAreRefusedInTime) {
  EXPECT_NE(refusal(std::string(2000, '[')), "");
  EXPECT_NE(refusal("{\"do\":" + std::string(2000, '[') + std::string(2000, ']') + "}"), "");
}

}  // namespace command_test
}  // namespace supple

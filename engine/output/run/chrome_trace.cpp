#include "output/run/chrome_trace.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "output/files/json_text.h"

namespace supple {
namespace {

// Names of bodies are free text, and may have been cut in the middle of a letter.
std::string json_string(const std::string& text) { return json_text(nlohmann::json(text)); }

// Keeps whole nanoseconds, so that zones nest in the file as they did in time.
std::string microseconds(std::int64_t ns) { return fmt::format("{}.{:03}", ns / 1000, ns % 1000); }

std::string arguments(const TraceEvent& event) {
  std::string text;
  if (event.number >= 0) text += fmt::format("\"frame\":{}", event.number);
  if (event.subject[0] != 0)
    text += fmt::format("{}\"body\":{}", text.empty() ? "" : ",", json_string(event.subject.data()));
  return text.empty() ? "" : ",\"args\":{" + text + "}";
}

}  // namespace

std::string chrome_trace(const std::vector<ThreadTrace>& threads) {
  std::int64_t origin = std::numeric_limits<std::int64_t>::max();
  long lost = 0;
  for (const ThreadTrace& thread : threads) {
    lost += thread.lost;
    if (!thread.events.empty()) origin = std::min(origin, thread.events.front().begin_ns);
  }
  std::string text =
      fmt::format("{{\"displayTimeUnit\":\"ms\",\"otherData\":{{\"lost_zones\":{}}},\"traceEvents\":[\n", lost);
  text += R"({"ph":"M","pid":1,"tid":0,"name":"process_name","args":{"name":"supple"}})";
  int track = 0;
  for (const ThreadTrace& thread : threads) {
    ++track;
    const std::string name = thread.number > 0 ? fmt::format("{} {}", thread.name, thread.number) : thread.name;
    text += fmt::format(",\n{{\"ph\":\"M\",\"pid\":1,\"tid\":{},\"name\":\"thread_name\",\"args\":{{\"name\":{}}}}}",
                        track, json_string(name));
    for (const TraceEvent& event : thread.events) {
      fmt::format_to(std::back_inserter(text),
                     ",\n{{\"ph\":\"X\",\"pid\":1,\"tid\":{},\"name\":{},\"ts\":{},\"dur\":{}{}}}", track,
                     json_string(event.name), microseconds(event.begin_ns - origin),
                     microseconds(event.end_ns - event.begin_ns), arguments(event));
    }
  }
  return text + "\n]}\n";
}

}  // namespace supple

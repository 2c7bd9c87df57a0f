// Any text as a request to the live page: its method, path, headers and body, a line each.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "live/command.h"
#include "live/gate.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  static const Gate near("0123456789abcdef", Reach::loopback), far("0123456789abcdef", Reach::network);
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::vector<std::string_view> lines;
  while (lines.size() < 7) {
    const std::size_t end = rest.find('\n');
    lines.push_back(rest.substr(0, end));
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  const LiveRequest request{lines[0], lines[1], lines[2], lines[3], lines[4], lines[5], lines[6]};
  for (const Gate* gate : {&near, &far}) {
    const auto admitted = gate->admit(request);
    // Nobody passes without the token, whatever else the request has.
    if (std::holds_alternative<Route>(admitted) && !request.path.starts_with("/0123456789abcdef/")) __builtin_trap();
  }
  try {
    (void)read_command(rest);
  } catch (const InputError&) {
  }
  return 0;
}

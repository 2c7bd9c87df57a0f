// Serves work that takes long, such as making a mesh or a skin: its results are kept from run to run, and somebody
// hears of its progress.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "base/user_cache.h"

namespace supple {

struct SlowWork {
  UserCache cache;                               // where results are kept; the default keeps nothing
  std::function<void(const std::string&)> tell;  // is called with what is being made, and how far it is; may be empty
};

// Returns the result that is kept under the name, or else what make() returns, which is then kept. decode: a function
// from bytes to an optional result; bytes_of(result) must give these bytes.
template <class Decode, class Make>
auto kept_or_made(const UserCache& cache, const std::string& name, const Decode& decode, const Make& make) {
  if (const auto bytes = cache.find(name)) {
    if (auto result = decode(*bytes)) return std::move(*result);
  }
  auto result = make();
  if (!cache.folder().empty()) cache.keep(name, bytes_of(result));
  return result;
}

}  // namespace supple

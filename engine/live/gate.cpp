#include "live/gate.h"

#include <fmt/core.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "output/files/json_text.h"

namespace supple {
namespace {

struct OpenRoute {
  std::string_view path, method;
  Route route;
};
constexpr auto routes = std::to_array<OpenRoute>({{"", "GET", Route::page},
                                                  {"live.css", "GET", Route::style},
                                                  {"live.js", "GET", Route::script},
                                                  {"icon.svg", "GET", Route::icon},
                                                  {"picture", "GET", Route::picture},
                                                  {"events", "GET", Route::events},
                                                  {"replay", "GET", Route::replay},
                                                  {"claim", "POST", Route::claim},
                                                  {"do", "POST", Route::act}});

// Compares two texts in a time that tells nothing but their lengths.
bool are_same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

// Returns a host without its port.
std::string_view name_of_host(std::string_view host) {
  if (host.starts_with('[')) return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

// Tells whether a host is an address in numbers, which no name server has a part in.
bool is_address(std::string_view name) {
  if (name.starts_with('[')) return name.ends_with(']');
  return !name.empty() && name.find_first_not_of("0123456789.") == std::string_view::npos;
}

}  // namespace

Answer refusal_of(int status, const std::string& text) {
  return {status, json_text(nlohmann::ordered_json{{"error", text}})};
}

Reach reach_of(std::string_view address) {
  return address == "127.0.0.1" || address == "::1" ? Reach::loopback : Reach::network;
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != std::ssize(bytes))
    throw RunError("the system gives no random numbers, without which a live page would be open to anybody");
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

bool Gate::is_own_host(std::string_view host) const {
  const std::string_view name = name_of_host(host);
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]" ||
         (reach_ == Reach::network && is_address(name));
}

std::variant<Route, Answer> Gate::admit(const LiveRequest& request) const {
  if (!is_own_host(request.host)) return refusal_of(403, "this is not the name of this host");
  if (!request.origin.empty() && request.origin != fmt::format("http://{}", request.host))
    return refusal_of(403, "the request comes from another page");
  const std::string_view path = request.path;
  const std::size_t slash = path.find('/', 1);
  const std::string_view token = path.substr(0, slash).substr(std::min<std::size_t>(1, path.size()));
  if (!path.starts_with('/') || slash == std::string_view::npos || !are_same_secret(token, token_))
    return refusal_of(404, "nothing is here: the address of the page is in the terminal where it was started");
  const auto found = std::ranges::find(routes, path.substr(slash + 1), &OpenRoute::path);
  if (found == routes.end()) return refusal_of(404, "nothing is here");
  if (found->method != request.method) return refusal_of(405, fmt::format("wants {}", found->method));
  std::size_t length = 0;
  const char* end = request.length.data() + request.length.size();
  const auto [read_to, error] = std::from_chars(request.length.data(), end, length);
  const bool is_number = error == std::errc() && read_to == end;
  if (!request.length.empty() && (!is_number || length > most_bytes))
    return refusal_of(413, fmt::format("a request has at most {} bytes", most_bytes));
  return found->route;
}

namespace {

constexpr std::chrono::seconds grace{5};  // for a page that is loaded again

}  // namespace

std::optional<std::string> Steering::claim(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (!key_.empty() && (connections_ > 0 || now - alone_since_ < grace)) return std::nullopt;
  key_ = random_token();
  connections_ = 0;
  alone_since_ = now;
  return key_;
}

bool Steering::is_writer(std::string_view key) const {
  const std::lock_guard lock(mutex_);
  return !key_.empty() && are_same_secret(key, key_);
}

void Steering::connected(std::string_view key) {
  const std::lock_guard lock(mutex_);
  if (key == key_) ++connections_;
}

bool Steering::disconnected(std::string_view key, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (key != key_) return false;  // the key of a page that was forgotten
  --connections_;
  alone_since_ = now;
  return connections_ == 0;
}

bool RateLimit::allows(Clock::time_point now) {
  const std::chrono::duration<double> passed = now - counted_at_;
  counted_at_ = now;
  allowed_ = std::min(at_once_, allowed_ + a_second_ * std::min(passed.count(), at_once_ / a_second_));
  if (allowed_ < 1) return false;
  allowed_ -= 1;
  return true;
}

}  // namespace supple

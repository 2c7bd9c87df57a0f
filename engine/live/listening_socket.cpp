#include "live/listening_socket.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace supple {
namespace {

// Holds an address of either family, as the system takes it.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;
  bool is_v6() const { return storage.ss_family == AF_INET6; }
  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  int port() const {
    return ntohs(is_v6() ? reinterpret_cast<const sockaddr_in6&>(storage).sin6_port
                         : reinterpret_cast<const sockaddr_in&>(storage).sin_port);
  }
};

SocketAddress socket_address(const LiveAddress& address) {
  SocketAddress result;
  auto& v4 = reinterpret_cast<sockaddr_in&>(result.storage);
  auto& v6 = reinterpret_cast<sockaddr_in6&>(result.storage);
  const auto port = htons(static_cast<std::uint16_t>(address.port));
  if (inet_pton(AF_INET, address.address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = port;
    result.size = sizeof v4;
  } else if (inet_pton(AF_INET6, address.address.c_str(), &v6.sin6_addr) == 1) {
    v6.sin6_family = AF_INET6;
    v6.sin6_port = port;
    result.size = sizeof v6;
  } else {
    throw InputError(fmt::format("--listen {}", address.address),
                     "wants an address in numbers, such as 127.0.0.1 or 0.0.0.0");
  }
  return result;
}

[[noreturn]] void refuse(const LiveAddress& address, int error) {
  const bool is_port = error == EADDRINUSE || error == EACCES;
  throw InputError(is_port ? fmt::format("--port {}", address.port) : fmt::format("--listen {}", address.address),
                   fmt::format("cannot be listened to: {}", std::strerror(error)));
}

}  // namespace

ListeningSocket listen_to(const LiveAddress& address) {
  SocketAddress place = socket_address(address);
  const int descriptor = ::socket(place.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) refuse(address, errno);
  const int yes = 1;
  ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  constexpr int most_waiting = 64;
  if (::bind(descriptor, place.get(), place.size) != 0 || ::listen(descriptor, most_waiting) != 0 ||
      ::getsockname(descriptor, place.get(), &place.size) != 0) {
    const int error = errno;
    ::close(descriptor);
    refuse(address, error);
  }
  const char* form = place.is_v6() ? "[{}]:{}" : "{}:{}";
  return {descriptor, fmt::format(fmt::runtime(form), address.address, place.port())};
}

}  // namespace supple

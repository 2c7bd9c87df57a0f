// Opens the socket on which the live page is served.
#pragma once

#include <string>

namespace supple {

struct LiveAddress {
  std::string address = "127.0.0.1";  // numeric
  int port = 0;                       // 0: one that is free
};

struct ListeningSocket {
  int descriptor = -1;  // is the caller's to close
  std::string host;     // address and port, as URLs have them
};

// Opens a socket that listens at an address. Throws InputError where the address is none, or cannot be listened to.
ListeningSocket listen_to(const LiveAddress& address);

}  // namespace supple

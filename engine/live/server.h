// Serves the page of a live session over HTTP, by libmicrohttpd, on one thread that never waits for a frame, and for
// which no frame waits.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "live/session.h"

namespace supple {

struct LiveAddress {
  std::string address = "127.0.0.1";  // numeric
  int port = 0;                       // 0: one that is free
};

class LiveServer {
 public:
  // files: the folder of the page's files. Throws InputError where the address cannot be listened to, and RunError
  // where a file is missing. The desk must outlive this object.
  LiveServer(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files);
  ~LiveServer();

  // Returns the page's address, with the secret without which nothing is told.
  const std::string& url() const;

 private:
  class Hall;
  std::unique_ptr<Hall> hall_;
};

}  // namespace supple

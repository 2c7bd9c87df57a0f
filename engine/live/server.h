// Serves the page of a live session over HTTP, by libmicrohttpd, on one thread that never waits for a frame, and for
// which no frame waits.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "live/listening_socket.h"
#include "live/session.h"

namespace supple {

class LiveServer {
 public:
  // files: the folder of the page's files. Throws InputError where the address cannot be listened to, and RunError
  // where a file is missing. The desk must outlive this object.
  LiveServer(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files);
  ~LiveServer();

  // Returns the page's address, with the secret without which nothing is told.
  const std::string& url() const;

 private:
  class Connections;
  std::unique_ptr<Connections> connections_;
};

}  // namespace supple

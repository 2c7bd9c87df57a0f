// Makes the responses of the live page's server, with the headers that all of them have.
#pragma once

#include <microhttpd.h>

#include <memory>
#include <string>

#include "live/mailbox.h"

namespace supple {

struct ResponseDeleter {
  void operator()(MHD_Response* response) const { MHD_destroy_response(response); }
};
using Response = std::unique_ptr<MHD_Response, ResponseDeleter>;  // connections that send it have shares of their own

// Adds the headers to a response, and takes it over. type: of its content.
Response with_headers(MHD_Response* response, const char* type);
// Returns a response with a copy of these bytes.
Response response_of(const void* bytes, std::size_t size, const char* type);
Response response_of(const std::string& text, const char* type = "application/json");

// Sends a response. Returns what the handler of a request is to return to the library.
MHD_Result send(MHD_Connection* connection, int status, const Response& response);
MHD_Result send(MHD_Connection* connection, const Answer& answer);

}  // namespace supple

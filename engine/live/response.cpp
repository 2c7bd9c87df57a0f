#include "live/response.h"

#include <array>
#include <utility>

namespace supple {
namespace {

// Nothing is taken from elsewhere, no other page shows this one, and none learns its address.
constexpr std::array<std::pair<const char*, const char*>, 6> headers = {{
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; base-uri 'none'; "
     "form-action 'none'; frame-ancestors 'none'"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Referrer-Policy", "no-referrer"},
    {"X-Content-Type-Options", "nosniff"},
    {"Cache-Control", "no-store"},
}};

}  // namespace

Response with_headers(MHD_Response* response, const char* type) {
  for (const auto& [name, value] : headers) MHD_add_response_header(response, name, value);
  MHD_add_response_header(response, "Content-Type", type);
  return Response(response);
}

Response response_of(const void* bytes, std::size_t size, const char* type) {
  return with_headers(MHD_create_response_from_buffer(size, const_cast<void*>(bytes), MHD_RESPMEM_MUST_COPY), type);
}

Response response_of(const std::string& text, const char* type) { return response_of(text.data(), text.size(), type); }

MHD_Result send(MHD_Connection* connection, int status, const Response& response) {
  return MHD_queue_response(connection, static_cast<unsigned>(status), response.get());
}

MHD_Result send(MHD_Connection* connection, const Answer& answer) {
  return send(connection, answer.status, response_of(answer.body));
}

}  // namespace supple

#include "live/server.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <microhttpd.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <condition_variable>
#include <fstream>
#include <list>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "base/signals.h"
#include "base/trace.h"
#include "live/gate.h"

namespace supple {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned most_connections = 600;
constexpr unsigned silence_s = 10;  // after which a connection that makes no progress is closed
constexpr std::size_t connection_memory = 16384;
constexpr std::chrono::seconds longest_wait{10};  // for a picture
constexpr std::chrono::seconds between_beats{1};  // of the stream of events, which find out readers that have gone
constexpr std::size_t piece_of_stream = 8192;

// Nothing is taken from elsewhere, no other page shows this one, and none learns its address.
constexpr std::array<std::pair<const char*, const char*>, 6> headers = {{
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; "
     "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Referrer-Policy", "no-referrer"},
    {"X-Content-Type-Options", "nosniff"},
    {"Cache-Control", "no-store"},
}};

struct ResponseDeleter {
  void operator()(MHD_Response* response) const { MHD_destroy_response(response); }
};
using Response = std::unique_ptr<MHD_Response, ResponseDeleter>;  // connections that send it have shares of their own

Response with_headers(MHD_Response* response, const char* type) {
  for (const auto& [name, value] : headers) MHD_add_response_header(response, name, value);
  MHD_add_response_header(response, "Content-Type", type);
  return Response(response);
}

Response response_of(const void* bytes, std::size_t size, const char* type) {
  return with_headers(MHD_create_response_from_buffer(size, const_cast<void*>(bytes), MHD_RESPMEM_MUST_COPY), type);
}

Response response_of(const std::string& text, const char* type = "application/json") {
  return response_of(text.data(), text.size(), type);
}

std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw RunError(fmt::format("{}: cannot be read, and belongs to the live page", path.string()));
  return text.str();
}

std::string_view header_of(MHD_Connection* connection, const char* name, MHD_ValueKind kind = MHD_HEADER_KIND) {
  const char* value = MHD_lookup_connection_value(connection, kind, name);
  return value != nullptr ? value : "";
}

LiveRequest request_of(MHD_Connection* connection, const char* url, const char* method) {
  LiveRequest request{method,
                      url,
                      header_of(connection, "Host"),
                      header_of(connection, "Origin"),
                      header_of(connection, "Content-Length"),
                      header_of(connection, "X-Writer"),
                      header_of(connection, "after", MHD_GET_ARGUMENT_KIND)};
  if (request.writer.empty()) request.writer = header_of(connection, "writer", MHD_GET_ARGUMENT_KIND);
  return request;
}

// Holds a connection that may be suspended, until something comes for it.
struct Waiting {
  MHD_Connection* connection = nullptr;
  bool suspended = false;
};

// Represents one request from its first header to its last byte.
struct Visit : Waiting {
  Door door = Door::page;
  std::string writer, body;
  std::uint64_t after = 0;
  Clock::time_point until;  // a picture comes
  bool is_posted = false;   // the command waits for its answer
  std::optional<Answer> answer;
};

// Represents a stream of events to one page.
struct Reader : Waiting {
  std::string writer;  // its key; empty for a page that watches
  std::uint64_t seen = 0;
  std::string text;      // that is being sent
  std::size_t sent = 0;  // of it
  bool wants_beat = false;
};

}  // namespace

class LiveServer::Hall {
 public:
  Hall(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files);
  ~Hall();
  Hall(const Hall&) = delete;
  Hall& operator=(const Hall&) = delete;

  std::string url;

 private:
  static MHD_Result handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char* version, const char* data, std::size_t* size, void** visit);
  static void forget(void* self, MHD_Connection* connection, void** visit, MHD_RequestTerminationCode reason);
  static ssize_t read_events(void* reader, std::uint64_t position, char* buffer, std::size_t size);
  static void close_reader(void* reader);

  MHD_Result welcome(MHD_Connection* connection, const LiveRequest& request, void** visit);
  MHD_Result serve(MHD_Connection* connection, const std::shared_ptr<Visit>& visit);
  MHD_Result serve_picture(MHD_Connection* connection, const std::shared_ptr<Visit>& visit);
  MHD_Result serve_command(MHD_Connection* connection, const std::shared_ptr<Visit>& visit);
  MHD_Result serve_events(MHD_Connection* connection, const Visit& visit);
  std::optional<Answer> command_of(Visit& visit, Command& command);
  void change_view(const Command& command, std::uint64_t input);
  void suspend(Waiting& waiting) {
    waiting.suspended = true;
    MHD_suspend_connection(waiting.connection);
  }
  void resume(Waiting& waiting) {
    if (std::exchange(waiting.suspended, false)) MHD_resume_connection(waiting.connection);
  }
  void take_picture();
  void wake_readers();
  void beat();
  void listen(const LiveAddress& address);

  // Ties a reader to the hall, for the callbacks of its response.
  struct Seat {
    Hall* hall;
    Reader reader;
  };

  LiveDesk& desk_;
  Gate gate_;
  Steering steering_;
  std::string page_, style_, script_, icon_;
  std::mutex mutex_;  // guards all below, and what visits and readers hold
  std::list<std::shared_ptr<Visit>> for_picture_;
  std::list<Seat*> seats_;
  bool closes_ = false;
  std::uint64_t picture_number_ = 0;  // of `picture_`
  Response picture_;
  std::condition_variable beats_;
  MHD_Daemon* daemon_ = nullptr;
  std::thread beating_;
};

namespace {

MHD_Result send(MHD_Connection* connection, int status, const Response& response) {
  return MHD_queue_response(connection, static_cast<unsigned>(status), response.get());
}
MHD_Result send(MHD_Connection* connection, const Answer& answer) {
  return send(connection, answer.status, response_of(answer.body));
}

}  // namespace

LiveServer::Hall::Hall(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files)
    : desk_(desk),
      gate_(random_token(), address.address != "127.0.0.1" && address.address != "::1"),
      page_(text_of_file(files / "live.html")),
      style_(text_of_file(files / "live.css")),
      script_(text_of_file(files / "live.js")),
      icon_(text_of_file(files / "icon.svg")) {
  const BlockedSignals meanwhile;  // the thread that makes the frames takes signals
  listen(address);
  desk_.pictures.on_picture([this] { take_picture(); });
  desk_.events.on_event([this] { wake_readers(); });
  beating_ = std::thread([this] {
    name_thread("live page");
    beat();
  });
}

void LiveServer::Hall::listen(const LiveAddress& address) {
  sockaddr_storage storage{};
  const bool is_v6 = address.address.find(':') != std::string::npos;
  auto* v4 = reinterpret_cast<sockaddr_in*>(&storage);
  auto* v6 = reinterpret_cast<sockaddr_in6*>(&storage);
  const std::string place = fmt::format("--listen {}", address.address);
  if (is_v6) {
    v6->sin6_family = AF_INET6;
    v6->sin6_port = htons(static_cast<std::uint16_t>(address.port));
  } else {
    v4->sin_family = AF_INET;
    v4->sin_port = htons(static_cast<std::uint16_t>(address.port));
  }
  void* to = is_v6 ? static_cast<void*>(&v6->sin6_addr) : &v4->sin_addr;
  if (inet_pton(is_v6 ? AF_INET6 : AF_INET, address.address.c_str(), to) != 1)
    throw InputError(place, "wants an address in numbers, such as 127.0.0.1 or 0.0.0.0");
  const unsigned flags = MHD_USE_EPOLL | MHD_USE_INTERNAL_POLLING_THREAD | MHD_ALLOW_SUSPEND_RESUME |
                         (is_v6 ? static_cast<unsigned>(MHD_USE_IPv6) : 0U);
  daemon_ = MHD_start_daemon(flags, 0, nullptr, nullptr, &Hall::handle, this, MHD_OPTION_SOCK_ADDR,
                             reinterpret_cast<sockaddr*>(&storage), MHD_OPTION_CONNECTION_LIMIT, most_connections,
                             MHD_OPTION_CONNECTION_TIMEOUT, silence_s, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
                             connection_memory, MHD_OPTION_NOTIFY_COMPLETED, &Hall::forget, this, MHD_OPTION_END);
  if (daemon_ == nullptr)
    throw InputError(place, fmt::format("cannot be listened to on port {}: another program may use it", address.port));
  const MHD_DaemonInfo* info = MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_BIND_PORT);
  const std::string host = is_v6 ? fmt::format("[{}]", address.address) : address.address;
  url = fmt::format("http://{}:{}/{}/", host, info->port, gate_.token());
}

LiveServer::Hall::~Hall() {
  desk_.pictures.on_picture(nullptr);
  desk_.events.on_event(nullptr);
  {
    const std::lock_guard lock(mutex_);
    closes_ = true;
    for (const std::shared_ptr<Visit>& visit : for_picture_) resume(*visit);
    for_picture_.clear();
    for (Seat* seat : seats_) resume(seat->reader);
    beats_.notify_one();
  }
  beating_.join();
  MHD_stop_daemon(daemon_);
}

// Is called by the library for each part of a request: its head, pieces of its body, its end, and when it goes on after
// it was suspended.
MHD_Result LiveServer::Hall::handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                                    const char*, const char* data, std::size_t* size, void** state) {
  auto& hall = *static_cast<Hall*>(self);
  try {
    if (*state == nullptr) return hall.welcome(connection, request_of(connection, url, method), state);
    const auto& visit = *static_cast<std::shared_ptr<Visit>*>(*state);
    if (*size > 0) {
      if (visit->body.size() + *size > most_bytes) return MHD_NO;  // more than was announced
      visit->body.append(data, *size);
      *size = 0;
      return MHD_YES;
    }
    return hall.serve(connection, visit);
  } catch (const std::exception&) {
    return MHD_NO;  // without memory the connection is closed
  }
}

MHD_Result LiveServer::Hall::welcome(MHD_Connection* connection, const LiveRequest& request, void** state) {
  const std::variant<Door, Answer> admitted = gate_.admit(request);
  if (const Answer* refusal = std::get_if<Answer>(&admitted)) return send(connection, *refusal);
  auto visit = std::make_shared<Visit>();
  visit->connection = connection;
  visit->door = std::get<Door>(admitted);
  visit->writer = request.writer;
  std::from_chars(request.after.data(), request.after.data() + request.after.size(), visit->after);
  visit->until = Clock::now() + longest_wait;
  *state = new std::shared_ptr<Visit>(std::move(visit));  // forget() frees it
  return MHD_YES;
}

void LiveServer::Hall::forget(void*, MHD_Connection*, void** state, MHD_RequestTerminationCode) {
  delete static_cast<std::shared_ptr<Visit>*>(*state);
  *state = nullptr;
}

MHD_Result LiveServer::Hall::serve(MHD_Connection* connection, const std::shared_ptr<Visit>& visit) {
  switch (visit->door) {
    case Door::page: return send(connection, 200, response_of(page_, "text/html; charset=utf-8"));
    case Door::style: return send(connection, 200, response_of(style_, "text/css; charset=utf-8"));
    case Door::script: return send(connection, 200, response_of(script_, "text/javascript; charset=utf-8"));
    case Door::icon: return send(connection, 200, response_of(icon_, "image/svg+xml"));
    case Door::claim: {
      const std::optional<std::string> key = steering_.claim(Clock::now());
      if (!key) return send(connection, refusal_of(409, "somebody else steers"));
      return send(connection, {200, fmt::format("{{\"writer\":\"{}\"}}", *key)});
    }
    case Door::picture: return serve_picture(connection, visit);
    case Door::events: return serve_events(connection, *visit);
    case Door::replay:
    case Door::act: return serve_command(connection, visit);
  }
  return MHD_NO;
}

// Makes the response of a new picture, which all who wait for it share, and lets them go on.
void LiveServer::Hall::take_picture() {
  const std::shared_ptr<const LivePicture> newest = desk_.pictures.newest();
  Response response = response_of(newest->jpeg.data(), newest->jpeg.size(), "image/jpeg");
  MHD_add_response_header(response.get(), "X-Picture", fmt::format("{}", newest->number).c_str());
  MHD_add_response_header(response.get(), "X-Frame", fmt::format("{}", newest->frame).c_str());
  MHD_add_response_header(response.get(), "X-Input", fmt::format("{}", newest->input).c_str());
  const std::lock_guard lock(mutex_);
  picture_ = std::move(response);
  picture_number_ = newest->number;
  for (const std::shared_ptr<Visit>& visit : for_picture_) resume(*visit);
  for_picture_.clear();
}

MHD_Result LiveServer::Hall::serve_picture(MHD_Connection* connection, const std::shared_ptr<Visit>& visit) {
  const std::lock_guard lock(mutex_);
  if (picture_ && picture_number_ > visit->after) return MHD_queue_response(connection, 200, picture_.get());
  if (closes_ || Clock::now() >= visit->until) return send(connection, 204, response_of(""));
  for_picture_.push_back(visit);
  suspend(*visit);
  return MHD_YES;
}

// Reads the command of a request. Returns why it is refused; nothing where it is not.
std::optional<Answer> LiveServer::Hall::command_of(Visit& visit, Command& command) {
  if (visit.door == Door::replay) {
    command.deed = Deed::save;
  } else if (!steering_.is_writer(visit.writer)) {
    return refusal_of(403, "this page does not steer");
  }
  if (!steering_.allows_command(Clock::now())) return refusal_of(429, "too many commands in a short time");
  if (visit.door == Door::replay) return std::nullopt;
  try {
    command = read_command(visit.body);
  } catch (const InputError& error) {
    return refusal_of(422, error.problems().front().message);
  }
  if (command.deed == Deed::save) return refusal_of(422, "do: the replay has its own address");
  return std::nullopt;
}

// Changes the camera without waiting for a frame.
void LiveServer::Hall::change_view(const Command& command, std::uint64_t input) {
  desk_.pictures.change_view(
      [&command](LiveView& view) {
        if (command.deed == Deed::orbit) view.orbit(command.at);
        if (command.deed == Deed::pan) view.pan(command.at);
        if (command.deed == Deed::zoom) view.zoom(command.factor);
        if (command.deed == Deed::home) view.home();
      },
      input);
}

MHD_Result LiveServer::Hall::serve_command(MHD_Connection* connection, const std::shared_ptr<Visit>& visit) {
  if (visit->is_posted) {
    const std::lock_guard lock(mutex_);
    return send(connection, visit->answer.value_or(refusal_of(503, "the program has ended")));
  }
  Command command;
  if (const std::optional<Answer> refusal = command_of(*visit, command)) return send(connection, *refusal);
  const std::uint64_t input = ++desk_.inputs;
  const bool is_view = command.deed == Deed::orbit || command.deed == Deed::pan || command.deed == Deed::zoom ||
                       command.deed == Deed::home;
  if (is_view) {
    change_view(command, input);
    return send(connection, {200, fmt::format("{{\"input\":{}}}", input)});
  }
  visit->is_posted = true;
  suspend(*visit);
  const auto take = [this, visit](Answer answer) {
    const std::lock_guard lock(mutex_);
    visit->answer = std::move(answer);
    resume(*visit);
  };
  if (!desk_.mailbox.post({std::move(command), input, take})) take(refusal_of(429, "too many commands wait"));
  return MHD_YES;
}

MHD_Result LiveServer::Hall::serve_events(MHD_Connection* connection, const Visit& visit) {
  const bool steers = !visit.writer.empty();
  if (steers && !steering_.is_writer(visit.writer))
    return send(connection, refusal_of(403, "this page does not steer"));
  auto seat = std::make_unique<Seat>(Seat{this, {}});
  seat->reader.connection = connection;
  seat->reader.writer = visit.writer;
  const Response response =
      with_headers(MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, piece_of_stream, &Hall::read_events, seat.get(),
                                                     &Hall::close_reader),
                   "text/event-stream");
  if (steers) steering_.connected(visit.writer);
  const std::lock_guard lock(mutex_);
  seats_.push_back(seat.release());  // close_reader() frees it
  return send(connection, 200, response);
}

// Gives the library the next piece of a stream of events, or lets the connection wait for one.
ssize_t LiveServer::Hall::read_events(void* place, std::uint64_t, char* buffer, std::size_t size) {
  auto& [hall, reader] = *static_cast<Seat*>(place);
  const std::lock_guard lock(hall->mutex_);
  if (hall->closes_) return MHD_CONTENT_READER_END_OF_STREAM;
  if (reader.sent == reader.text.size()) {
    reader.text = hall->desk_.events.text_after(reader.seen, !reader.writer.empty());
    reader.sent = 0;
    if (std::exchange(reader.wants_beat, false) && reader.text.empty()) reader.text = ":\n\n";
  }
  if (reader.text.empty()) {
    hall->suspend(reader);
    return 0;
  }
  const std::size_t count = std::min(size, reader.text.size() - reader.sent);
  std::copy_n(reader.text.data() + reader.sent, count, buffer);
  reader.sent += count;
  return static_cast<ssize_t>(count);
}

void LiveServer::Hall::close_reader(void* place) {
  const std::unique_ptr<Seat> seat(static_cast<Seat*>(place));
  Hall& hall = *seat->hall;
  {
    const std::lock_guard lock(hall.mutex_);
    hall.seats_.remove(seat.get());
  }
  const std::string& writer = seat->reader.writer;
  if (writer.empty() || !hall.steering_.disconnected(writer, Clock::now())) return;
  Command drop;  // a hand that has gone holds nothing
  drop.deed = Deed::drop;
  hall.desk_.mailbox.post({drop, 0, [](const Answer&) {}});
}

void LiveServer::Hall::wake_readers() {
  const std::lock_guard lock(mutex_);
  for (Seat* seat : seats_) resume(seat->reader);
}

// Lets those go on who have waited long enough, and sends something to those who hear nothing.
void LiveServer::Hall::beat() {
  std::unique_lock lock(mutex_);
  while (!closes_) {
    beats_.wait_for(lock, between_beats);
    const Clock::time_point now = Clock::now();
    for (const std::shared_ptr<Visit>& visit : for_picture_)
      if (now >= visit->until) resume(*visit);
    for_picture_.remove_if([](const std::shared_ptr<Visit>& visit) { return !visit->suspended; });
    for (Seat* seat : seats_) {
      seat->reader.wants_beat = true;
      resume(seat->reader);
    }
  }
}

LiveServer::LiveServer(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files)
    : hall_(std::make_unique<Hall>(desk, address, files)) {}
LiveServer::~LiveServer() = default;
const std::string& LiveServer::url() const { return hall_->url; }

}  // namespace supple

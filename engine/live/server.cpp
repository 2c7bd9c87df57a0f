#include "live/server.h"

#include <fmt/core.h>
#include <sys/socket.h>

#include <algorithm>
#include <charconv>
#include <condition_variable>
#include <fstream>
#include <list>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "base/signals.h"
#include "base/trace.h"
#include "live/gate.h"
#include "live/response.h"

namespace supple {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned most_connections = 600;
constexpr unsigned silence_s = 10;  // after which a connection that makes no progress is closed
constexpr std::size_t connection_memory = 16384;
constexpr std::chrono::seconds patience{5};       // with a connection that has not asked for anything that it may have
constexpr std::chrono::seconds longest_wait{10};  // for a picture
constexpr std::chrono::seconds between_beats{1};  // of the streams of events, by which readers that have gone are found
constexpr std::size_t piece_of_stream = 8192;

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

// Represents a connection that may be suspended, until something comes for it.
struct Suspendable {
  MHD_Connection* connection = nullptr;
  bool suspended = false;
};

// Represents one request and its response.
struct Exchange : Suspendable {
  Route route = Route::page;
  std::string writer, body;
  std::uint64_t after = 0;
  Clock::time_point until;  // when it stops waiting for a picture
  bool is_posted = false;   // the command waits for its answer
  std::optional<Answer> answer;
};

bool is_of_view(const Command& command) {
  return command.kind == CommandKind::orbit || command.kind == CommandKind::pan || command.kind == CommandKind::zoom ||
         command.kind == CommandKind::home;
}

void apply(const Command& command, LiveView& view) {
  if (command.kind == CommandKind::orbit) view.orbit(command.at);
  if (command.kind == CommandKind::pan) view.pan(command.at);
  if (command.kind == CommandKind::zoom) view.zoom(command.factor);
  if (command.kind == CommandKind::home) view.home();
}

}  // namespace

class LiveServer::Connections {
 public:
  Connections(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files);
  ~Connections();
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;

  std::string url;

 private:
  // Represents the stream of events to one page.
  struct EventStream : Suspendable {
    Connections* owner = nullptr;
    std::string writer;  // its key; empty for a page that watches
    std::uint64_t seen = 0;
    std::string text;      // that is being sent
    std::size_t sent = 0;  // of it
    bool wants_beat = false, ends = false;
  };
  // Describes a connection that has not asked for anything yet that it may have.
  struct Stranger {
    MHD_Connection* connection;
    int socket;
    Clock::time_point since;
  };

  // These are called by the library.
  static MHD_Result handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char* version, const char* data, std::size_t* size, void** exchange);
  static void forget(void* self, MHD_Connection* connection, void** exchange, MHD_RequestTerminationCode reason);
  static void notice(void* self, MHD_Connection* connection, void** socket, MHD_ConnectionNotificationCode what);
  static ssize_t read_events(void* stream, std::uint64_t position, char* buffer, std::size_t size);
  static void close_stream(void* stream);

  MHD_Result begin_exchange(MHD_Connection* connection, const LiveRequest& request, void** exchange);
  MHD_Result serve(MHD_Connection* connection, const std::shared_ptr<Exchange>& exchange);
  MHD_Result serve_claim(MHD_Connection* connection);
  MHD_Result serve_picture(MHD_Connection* connection, const std::shared_ptr<Exchange>& exchange);
  MHD_Result serve_command(MHD_Connection* connection, const std::shared_ptr<Exchange>& exchange);
  MHD_Result serve_events(MHD_Connection* connection, const Exchange& exchange);
  std::optional<Answer> read_command_of(const Exchange& exchange, Command& command);
  void end_other_streams(const std::string& writer);
  void suspend(Suspendable& one);
  void resume(Suspendable& one);
  void take_picture();
  void wake_streams();
  void tell_whether_steered(bool is_steered);
  void beat();

  LiveDesk& desk_;
  Gate gate_;
  Steering steering_;
  RateLimit commands_{300, 300}, replays_{1, 5};
  std::string page_, style_, script_, icon_;
  std::mutex mutex_;  // guards all below, and what exchanges and streams hold
  std::list<std::shared_ptr<Exchange>> for_picture_;
  std::set<Suspendable*> suspended_;
  std::list<EventStream*> streams_;
  std::list<Stranger> strangers_;
  bool closes_ = false;
  std::uint64_t picture_number_ = 0;  // of `picture_`
  Response picture_;
  std::condition_variable beats_;
  MHD_Daemon* daemon_ = nullptr;
  std::thread beating_;
};

LiveServer::Connections::Connections(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files)
    : desk_(desk),
      gate_(random_token(), reach_of(address.address)),
      page_(text_of_file(files / "live.html")),
      style_(text_of_file(files / "live.css")),
      script_(text_of_file(files / "live.js")),
      icon_(text_of_file(files / "icon.svg")) {
  const BlockedSignals meanwhile;  // the thread that makes the frames takes signals
  const ListeningSocket socket = listen_to(address);
  url = fmt::format("http://{}/{}/", socket.host, gate_.token());
  daemon_ = MHD_start_daemon(MHD_USE_EPOLL | MHD_USE_INTERNAL_POLLING_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr,
                             nullptr, &Connections::handle, this, MHD_OPTION_LISTEN_SOCKET, socket.descriptor,
                             MHD_OPTION_CONNECTION_LIMIT, most_connections, MHD_OPTION_CONNECTION_TIMEOUT, silence_s,
                             MHD_OPTION_CONNECTION_MEMORY_LIMIT, connection_memory, MHD_OPTION_NOTIFY_COMPLETED,
                             &Connections::forget, this, MHD_OPTION_NOTIFY_CONNECTION, &Connections::notice, this,
                             MHD_OPTION_END);
  if (daemon_ == nullptr) throw RunError("the server of the live page could not be started");
  tell_whether_steered(false);
  desk_.pictures.on_picture([this] { take_picture(); });
  desk_.events.on_event([this] { wake_streams(); });
  beating_ = std::thread([this] {
    name_thread("live page");
    beat();
  });
}

LiveServer::Connections::~Connections() {
  desk_.pictures.on_picture(nullptr);
  desk_.events.on_event(nullptr);
  {
    const std::lock_guard lock(mutex_);
    closes_ = true;
    while (!suspended_.empty()) resume(**suspended_.begin());  // the daemon cannot stop while a connection is suspended
    beats_.notify_one();
  }
  beating_.join();
  MHD_stop_daemon(daemon_);
}

void LiveServer::Connections::suspend(Suspendable& one) {
  one.suspended = true;
  suspended_.insert(&one);
  MHD_suspend_connection(one.connection);
}

void LiveServer::Connections::resume(Suspendable& one) {
  if (!std::exchange(one.suspended, false)) return;
  suspended_.erase(&one);
  MHD_resume_connection(one.connection);
}

// Is called for each part of a request: its head, pieces of its body, its end, and when it continues after it was
// suspended.
MHD_Result LiveServer::Connections::handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                                           const char*, const char* data, std::size_t* size, void** state) {
  auto& own = *static_cast<Connections*>(self);
  try {
    if (*state == nullptr) return own.begin_exchange(connection, request_of(connection, url, method), state);
    const auto& exchange = *static_cast<std::shared_ptr<Exchange>*>(*state);
    if (*size > 0) {
      if (exchange->body.size() + *size > most_bytes) return MHD_NO;  // more than was announced
      exchange->body.append(data, *size);
      *size = 0;
      return MHD_YES;
    }
    return own.serve(connection, exchange);
  } catch (const std::exception&) {
    return MHD_NO;  // without memory the connection is closed
  }
}

MHD_Result LiveServer::Connections::begin_exchange(MHD_Connection* connection, const LiveRequest& request,
                                                   void** state) {
  const std::variant<Route, Answer> admitted = gate_.admit(request);
  if (const Answer* refusal = std::get_if<Answer>(&admitted)) return send(connection, *refusal);
  auto exchange = std::make_shared<Exchange>();
  exchange->connection = connection;
  exchange->route = std::get<Route>(admitted);
  exchange->writer = request.writer;
  std::from_chars(request.after.data(), request.after.data() + request.after.size(), exchange->after);
  exchange->until = Clock::now() + longest_wait;
  *state = new std::shared_ptr<Exchange>(std::move(exchange));  // forget() frees it
  const std::lock_guard lock(mutex_);
  std::erase_if(strangers_, [connection](const Stranger& one) { return one.connection == connection; });
  return MHD_YES;
}

void LiveServer::Connections::forget(void*, MHD_Connection*, void** state, MHD_RequestTerminationCode) {
  delete static_cast<std::shared_ptr<Exchange>*>(*state);
  *state = nullptr;
}

// Is called when a connection begins, and before its socket is closed.
void LiveServer::Connections::notice(void* self, MHD_Connection* connection, void**,
                                     MHD_ConnectionNotificationCode what) {
  auto& own = *static_cast<Connections*>(self);
  const std::lock_guard lock(own.mutex_);
  if (what == MHD_CONNECTION_NOTIFY_STARTED) {
    const MHD_ConnectionInfo* info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    own.strangers_.push_back({connection, info->connect_fd, Clock::now()});
  } else {
    std::erase_if(own.strangers_, [connection](const Stranger& one) { return one.connection == connection; });
  }
}

MHD_Result LiveServer::Connections::serve(MHD_Connection* connection, const std::shared_ptr<Exchange>& exchange) {
  switch (exchange->route) {
    case Route::page: return send(connection, 200, response_of(page_, "text/html; charset=utf-8"));
    case Route::style: return send(connection, 200, response_of(style_, "text/css; charset=utf-8"));
    case Route::script: return send(connection, 200, response_of(script_, "text/javascript; charset=utf-8"));
    case Route::icon: return send(connection, 200, response_of(icon_, "image/svg+xml"));
    case Route::claim: return serve_claim(connection);
    case Route::picture: return serve_picture(connection, exchange);
    case Route::events: return serve_events(connection, *exchange);
    case Route::replay:
    case Route::act: return serve_command(connection, exchange);
  }
  return MHD_NO;
}

MHD_Result LiveServer::Connections::serve_claim(MHD_Connection* connection) {
  const std::optional<std::string> key = steering_.claim(Clock::now());
  if (!key) return send(connection, refusal_of(409, "somebody else steers"));
  return send(connection, {200, fmt::format("{{\"writer\":\"{}\"}}", *key)});
}

// Makes the response of a new picture, which all who wait for it share, and resumes them.
void LiveServer::Connections::take_picture() {
  const std::shared_ptr<const LivePicture> newest = desk_.pictures.newest();
  Response response = response_of(newest->jpeg.data(), newest->jpeg.size(), "image/jpeg");
  MHD_add_response_header(response.get(), "X-Picture", fmt::format("{}", newest->number).c_str());
  MHD_add_response_header(response.get(), "X-Frame", fmt::format("{}", newest->frame).c_str());
  MHD_add_response_header(response.get(), "X-Input", fmt::format("{}", newest->input).c_str());
  const std::lock_guard lock(mutex_);
  picture_ = std::move(response);
  picture_number_ = newest->number;
  for (const std::shared_ptr<Exchange>& exchange : for_picture_) resume(*exchange);
  for_picture_.clear();
}

MHD_Result LiveServer::Connections::serve_picture(MHD_Connection* connection,
                                                  const std::shared_ptr<Exchange>& exchange) {
  const std::lock_guard lock(mutex_);
  if (picture_ && picture_number_ > exchange->after) return send(connection, 200, picture_);
  if (closes_ || Clock::now() >= exchange->until) return send(connection, 204, response_of(""));
  for_picture_.push_back(exchange);
  suspend(*exchange);
  return MHD_YES;
}

// Reads the command of a request. Returns why it is refused; nothing where it is not.
std::optional<Answer> LiveServer::Connections::read_command_of(const Exchange& exchange, Command& command) {
  if (exchange.route == Route::replay) {
    command.kind = CommandKind::save;
    if (replays_.allows(Clock::now())) return std::nullopt;
    return refusal_of(429, "the replay was asked for too often in a short time");
  }
  if (!steering_.is_writer(exchange.writer)) return refusal_of(403, "this page does not steer");
  if (!commands_.allows(Clock::now())) return refusal_of(429, "too many commands in a short time");
  try {
    command = read_command(exchange.body);
  } catch (const InputError& error) {
    return refusal_of(422, error.problems().front().message);
  }
  return std::nullopt;
}

MHD_Result LiveServer::Connections::serve_command(MHD_Connection* connection,
                                                  const std::shared_ptr<Exchange>& exchange) {
  if (exchange->is_posted) {
    const std::lock_guard lock(mutex_);
    return send(connection, exchange->answer.value_or(refusal_of(503, "the program has ended")));
  }
  Command command;
  if (const std::optional<Answer> refusal = read_command_of(*exchange, command)) return send(connection, *refusal);
  const std::uint64_t input = ++desk_.inputs;
  if (is_of_view(command)) {  // the camera does not wait for a frame
    desk_.pictures.change_view([&command](LiveView& view) { apply(command, view); }, input);
    return send(connection, {200, fmt::format("{{\"input\":{}}}", input)});
  }
  exchange->is_posted = true;
  const auto take = [this, exchange](Answer answer) {
    const std::lock_guard lock(mutex_);
    exchange->answer = std::move(answer);
    resume(*exchange);
  };
  {
    const std::lock_guard lock(mutex_);
    suspend(*exchange);
  }
  const auto reply = std::make_shared<Reply>(take);
  if (desk_.mailbox.post({std::move(command), input, reply}) == Posted::full)
    reply->give(refusal_of(429, "too many commands wait"));
  return MHD_YES;
}

MHD_Result LiveServer::Connections::serve_events(MHD_Connection* connection, const Exchange& exchange) {
  const bool steers = !exchange.writer.empty();
  if (steers && !steering_.is_writer(exchange.writer))
    return send(connection, refusal_of(403, "this page does not steer"));
  auto stream = std::make_unique<EventStream>();
  stream->connection = connection;
  stream->owner = this;
  stream->writer = exchange.writer;
  const Response response =
      with_headers(MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, piece_of_stream, &Connections::read_events,
                                                     stream.get(), &Connections::close_stream),
                   "text/event-stream");
  if (steers) {
    steering_.connected(exchange.writer);
    tell_whether_steered(true);
  }
  desk_.is_followed = true;
  const std::lock_guard lock(mutex_);
  if (steers) end_other_streams(exchange.writer);
  streams_.push_back(stream.release());  // close_stream() frees it
  return send(connection, 200, response);
}

// Ends the streams of other pages that have the key of this one: copies of it steer no more.
void LiveServer::Connections::end_other_streams(const std::string& writer) {
  for (EventStream* stream : streams_) {
    if (stream->writer != writer) continue;
    stream->text = stream->text.substr(stream->sent) + event_text("moved", "{}");
    stream->sent = 0;
    stream->ends = true;
    resume(*stream);
  }
}

// Gives the library the next piece of a stream of events, or lets the connection wait for one.
ssize_t LiveServer::Connections::read_events(void* place, std::uint64_t, char* buffer, std::size_t size) try {
  auto& stream = *static_cast<EventStream*>(place);
  Connections& own = *stream.owner;
  const std::lock_guard lock(own.mutex_);
  if (stream.sent == stream.text.size()) {
    stream.text = stream.ends ? "" : own.desk_.events.text_after(stream.seen, !stream.writer.empty());
    stream.sent = 0;
    if (std::exchange(stream.wants_beat, false) && stream.text.empty()) stream.text = ":\n\n";
    if (stream.text.empty() || stream.text == ":\n\n") {
      if (own.closes_ || stream.ends) return MHD_CONTENT_READER_END_OF_STREAM;
    }
  }
  if (stream.text.empty()) {
    own.suspend(stream);
    return 0;
  }
  const std::size_t count = std::min(size, stream.text.size() - stream.sent);
  std::copy_n(stream.text.data() + stream.sent, count, buffer);
  stream.sent += count;
  return static_cast<ssize_t>(count);
} catch (const std::exception&) {
  return MHD_CONTENT_READER_END_WITH_ERROR;
}

void LiveServer::Connections::close_stream(void* place) {
  const std::unique_ptr<EventStream> stream(static_cast<EventStream*>(place));
  Connections& own = *stream->owner;
  {
    const std::lock_guard lock(own.mutex_);
    own.streams_.remove(stream.get());
    own.suspended_.erase(stream.get());
  }
  if (stream->writer.empty() || !own.steering_.disconnected(stream->writer, Clock::now())) return;
  try {
    own.tell_whether_steered(false);
    Command drop;  // a hand that has gone holds nothing
    drop.kind = CommandKind::drop;
    own.desk_.mailbox.post({drop, 0, std::make_shared<Reply>(nullptr)}, true);
  } catch (const std::exception&) {  // without memory the hand goes on holding until a page lets go
  }
}

void LiveServer::Connections::tell_whether_steered(bool is_steered) {
  desk_.events.keep("steered", is_steered ? "true" : "false");
}

void LiveServer::Connections::wake_streams() {
  const std::lock_guard lock(mutex_);
  for (EventStream* stream : streams_) resume(*stream);
}

// Resumes those who have waited long enough, sends something to those who hear nothing, and closes connections that
// have not asked for anything in time.
void LiveServer::Connections::beat() {
  std::unique_lock lock(mutex_);
  while (!closes_) {
    beats_.wait_for(lock, between_beats);
    const Clock::time_point now = Clock::now();
    for (const std::shared_ptr<Exchange>& exchange : for_picture_)
      if (now >= exchange->until) resume(*exchange);
    for_picture_.remove_if([](const std::shared_ptr<Exchange>& exchange) { return !exchange->suspended; });
    for (EventStream* stream : streams_) {
      stream->wants_beat = true;
      resume(*stream);
    }
    for (const Stranger& stranger : strangers_)
      if (now - stranger.since > patience) ::shutdown(stranger.socket, SHUT_RDWR);
  }
}

LiveServer::LiveServer(LiveDesk& desk, const LiveAddress& address, const std::filesystem::path& files)
    : connections_(std::make_unique<Connections>(desk, address, files)) {}
LiveServer::~LiveServer() = default;
const std::string& LiveServer::url() const { return connections_->url; }

}  // namespace supple

#include "film/film_guide.h"

#include "base/interrupts.h"
#include "base/trace.h"

namespace supple {

std::optional<FilmEnd> FilmGuide::ends() {
  if (world_.frames() >= world_.scene().frames) return FilmEnd::done;
  if (interrupted()) return FilmEnd::interrupted;
  return std::nullopt;
}

void FilmGuide::begin() {
  if (!log_.keeps_checkpoints()) return;
  const Zone zone("checkpoint");
  checkpoint_before_ = world_.state();
}

void FilmGuide::take(FrameRow row) {
  const int frames = row.frame + 1;
  log_.add(std::move(row));
  if (log_.wants_checkpoint(frames)) add_checkpoint();
  settle();
  progress_.show(frames);
}

void FilmGuide::add_checkpoint() {
  const Zone zone("checkpoint");
  log_.add(world_.state());
}

// Tells the log which pictures have been written since the last call.
void FilmGuide::settle() {
  log_.settle(pictures_ != nullptr ? pictures_->take_written() : std::vector<PictureTimes>());
}

void FilmGuide::finish(FilmResult& result) {
  const Zone zone("finish film");
  if (pictures_ != nullptr) {
    pictures_->finish();
    result.gl_backend = pictures_->backend;
    result.gl_renderer = pictures_->renderer;
    result.gl_version = pictures_->version;
    if (const std::string error = pictures_->error(); !error.empty()) {
      result.end = FilmEnd::failed;
      result.message = error;
    }
  }
  const int frames = log_.frames();
  // After a failure the bodies may be in the middle of a frame, so the checkpoint before that frame is kept.
  if (result.end == FilmEnd::failed && checkpoint_before_.frames > first_)
    log_.add(checkpoint_before_);  // a checkpoint at first_ is there already
  const bool at_end = result.end != FilmEnd::failed && log_.keeps_checkpoints() && !log_.wants_checkpoint(frames);
  if (at_end) add_checkpoint();
  settle();
}

}  // namespace supple

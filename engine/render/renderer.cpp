#include "render/renderer.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/trace.h"
#include "render/color.h"
#include "render/exposure.h"
#include "render/projection.h"
#include "render/view.h"

namespace supple {
namespace {

std::string gl_text(const GlTable& gl, GLenum what) {
  const auto* text = reinterpret_cast<const char*>(gl.GetString(what));
  return text != nullptr ? text : "";
}

// Marks a stage of drawing as a zone. OpenGL works asynchronously; while a trace is recorded, each stage waits for it,
// so that the zone holds the stage's own time.
class DrawZone {
 public:
  DrawZone(const GlTable& gl, const char* name) : gl_(gl), zone_(name) {}
  void next(const char* name) {
    finish();
    zone_.next(name);
  }
  ~DrawZone() { finish(); }

 private:
  void finish() {
    if (trace_is_on.load(std::memory_order_relaxed)) gl_.Finish();
  }

  const GlTable& gl_;
  Zone zone_;
};

}  // namespace

// A flat backdrop has the colour that was asked for, whatever the light. The ground fades into what GroundShade
// has far from all bodies.
Vec3 backdrop_of(const Stage& stage) {
  if (stage.backdrop != Backdrop::ground) return stage.colors.background;
  const Vec3 linear = linear_of(stage.colors.background).cwiseProduct(stage.light.background_tint);
  return film_of(2 * linear, stage.colors.exposure);
}

Renderer::Renderer(const Stage& stage, GlChoice choice, const std::filesystem::path& shaders)
    : stage_(stage),
      shaders_(shaders),
      context_(choice),
      gl_(load_gl(context_)),
      name_(gl_text(gl_, GL_RENDERER)),
      version_(gl_text(gl_, GL_VERSION)),
      cover_(stage, stage.light.to_key.normalized()),
      samples_(stage.samples) {
  make_targets();
  shadows_ =
      std::make_unique<ShadowMap>(gl_, shaders, cover_.largest_body(), stage_.light.to_key.normalized(), stage_.width);
  if (stage_.backdrop == Backdrop::ground || stage_.backdrop == Backdrop::shadows)
    ground_ = std::make_unique<Ground>(gl_, shaders, stage_.width, stage_.height, cover_.largest_body(),
                                       stage_.backdrop == Backdrop::shadows ? GroundShown::shadows : GroundShown::all);
  tile_buffer_ = std::make_unique<TileBuffer>(gl_);
  textures_ = std::make_unique<TextureBuffer>(gl_, stage_.meshes);
  make_shading_program();
  prepare_field();
  make_surfaces();
  overlays_ = overlay_places(stage_);
  captions_ = std::make_unique<Captions>(stage_, overlays_.all(), overlays_.subtitles);
  graphs_ = std::make_unique<Graphs>(stage_, overlays_.graphs);
  subtitles_ = std::make_unique<Subtitles>(stage_);
  check_gl(gl_, "preparing the stage");
}

Renderer::~Renderer() {
  gl_.DeleteFramebuffers(1, &picture_framebuffer_);
  gl_.DeleteTextures(1, &visible_);
  gl_.DeleteTextures(1, &color_texture_);
  gl_.DeleteBuffers(1, &color_buffer_);
  gl_.DeleteTextures(1, &picture_color_);
}

void Renderer::make_targets() {
  gl_.GenTextures(1, &visible_);
  gl_.BindTexture(GL_TEXTURE_2D, visible_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RG32UI, stage_.width, stage_.height, 0, GL_RG_INTEGER, GL_UNSIGNED_INT, nullptr);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl_.GenFramebuffers(1, &picture_framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_);
  gl_.GenTextures(1, &picture_color_);
  gl_.BindTexture(GL_TEXTURE_2D, picture_color_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, stage_.width, stage_.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture_color_, 0);
  const GLenum status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw RunError(fmt::format("the picture's framebuffer is incomplete (0x{:04x})", status));
}

void Renderer::make_surfaces() {
  surfaces_ = std::make_unique<SurfaceBuffers>(gl_, stage_.meshes, *textures_);
  if (!visibility_ || visibility_->samples() != samples_) {
    visibility_ = std::make_unique<Visibility>(stage_.width, stage_.height, samples_, stage_.meshes);
  } else {
    visibility_->renew(stage_.meshes);
  }
  shading_program_->use();
  shading_program_->set_pairs("sample_places", visibility_->sample_places());
}

// Makes a program that shades what the stage's meshes have and no more.
void Renderer::make_shading_program() {
  make_rim_shadows();
  const auto constant = [](const char* name, const Vec3& value) {
    return fmt::format("{} vec3({}, {}, {})", name, value.x(), value.y(), value.z());
  };
  std::vector<std::string> definitions = {fmt::format("SAMPLES {}", samples_), constant("TO_FILL", LightRig::to_fill),
                                          constant("TO_RIM", LightRig::to_rim)};
  if (std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return !mesh.layers.empty(); }))
    definitions.emplace_back("PAINTED");
  if (std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return !mesh.square.empty(); }))
    definitions.emplace_back("PRINTED");
  if (std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return mesh.cloth.has_value(); }))
    definitions.emplace_back("CLOTH");
  if (stage_.field) definitions.emplace_back("FIELD");
  const bool colored =
      std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return !mesh.surface_colors.empty(); });
  if (colored) definitions.emplace_back("COLORED");
  if (std::ranges::any_of(stage_.meshes, &DrawMesh::wires)) definitions.emplace_back("WIRES");
  if (std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return mesh.finish.roughness.has_value(); }))
    definitions.emplace_back("ROUGH");
  if (rim_shadows_) definitions.emplace_back("TRANSLUCENT");
  if (shading_program_ && definitions == definitions_) return;
  definitions_ = definitions;
  shading_program_ = std::make_unique<Program>(gl_, shaders_, "tiles", "surface", definitions);
}

// Makes the shadow map of the rim light once something is translucent: it tells how far this light goes through a body.
// The map then stays, so that a film in which translucency comes and goes does not compile its shader again and again.
void Renderer::make_rim_shadows() {
  if (rim_shadows_ ||
      std::ranges::none_of(stage_.meshes, [](const DrawMesh& mesh) { return mesh.finish.translucent > 0; }))
    return;
  rim_shadows_ =
      std::make_unique<ShadowMap>(gl_, shaders_, cover_.largest_body(), LightRig::to_rim.normalized(), stage_.width);
}

// Makes the legend, and gives the colours of the field to the shader.
void Renderer::prepare_field() {
  if (!stage_.field) return;
  legend_ = legend_of(*stage_.field, stage_.font, stage_.width, stage_.height);
  std::vector<float> colors;
  for (const Vec3& color : stage_.field->colors) {
    for (int k = 0; k < 3; ++k) colors.push_back(static_cast<float>(color[k]));
    colors.push_back(1);
  }
  gl_.GenBuffers(1, &color_buffer_);
  gl_.BindBuffer(GL_TEXTURE_BUFFER, color_buffer_);
  gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(colors.size() * sizeof(float)), colors.data(),
                 GL_STATIC_DRAW);
  gl_.GenTextures(1, &color_texture_);
  gl_.BindTexture(GL_TEXTURE_BUFFER, color_texture_);
  gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, color_buffer_);
}

// Takes over what a list changes of the stage.
void Renderer::take_changes(const DrawList& list) {
  if (list.colors || !list.renewed.empty()) last_.reset();
  if (list.colors) stage_.colors = *list.colors;
  for (const auto& [m, mesh] : list.renewed) stage_.meshes[m] = mesh;
  if (!list.renewed.empty()) {
    sharp_.reset();
    make_shading_program();
    make_surfaces();
  }
  for (const auto& [m, caption] : list.captions) {
    stage_.meshes[m].label = caption;
    captions_->renew(m, caption);
  }
}

// Draws with so many samples a pixel from now on.
void Renderer::take_samples(int samples) {
  if (samples_ == samples) return;
  samples_ = samples;
  make_shading_program();
  make_surfaces();
}

// Finds what each pixel shows, and uploads the rectangle around the bodies.
void Renderer::find_visible(const Eigen::Matrix4f& view, const StageLight& light, const DrawList& list) {
  const double nearest = nearest_seen(list.camera, cover_.bounds().center(), cover_.reach());
  visibility_->find(stage_.meshes, list.positions, view, nearest, light.rays.up.norm());
  const Tiles::Area box = visibility_->tiles().around();
  if (box.width == 0) return;
  gl_.BindTexture(GL_TEXTURE_2D, visible_);
  gl_.PixelStorei(GL_UNPACK_ROW_LENGTH, stage_.width);
  gl_.TexSubImage2D(GL_TEXTURE_2D, 0, box.left, box.low, box.width, box.height, GL_RG_INTEGER, GL_UNSIGNED_INT,
                    &visibility_->surfaces()[2 * (std::size_t(box.low) * stage_.width + box.left)]);
  gl_.PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

void Renderer::shade(const StageLight& light) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  const Program& program = *shading_program_;
  program.use();
  set_light(program, light);
  int unit = surfaces_->bind(program, 0);
  shadows_->bind(program, unit++);
  unit = textures_->bind(program, unit);
  program.set_texture("visible", unit++, GL_TEXTURE_2D, visible_);
  if (stage_.field) program.set_texture("colors", unit++, GL_TEXTURE_BUFFER, color_texture_);
  if (rim_shadows_) rim_shadows_->bind_depths(program, "rim_map", "rim_matrix", unit++);
  program.set("wire_width", std::max(1.0, stage_.height / 720.0));
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // the samples are already weighted by their coverage
  tile_buffer_->draw(visibility_->tiles().corners());
  gl_.Disable(GL_BLEND);
}

Image Renderer::draw(const DrawList& list) {
  take_changes(list);
  Image image;
  image = list.exposure ? draw_exposed(list) : draw_sharp(list);
  DrawZone zone(gl_, "captions");
  draw_overlays(list, image);
  return image;
}

// Draws a picture of an instant, without words. Where nothing has moved since the picture before, that is the picture;
// where the camera alone has moved, the bodies' buffers and shadow maps stay.
Image Renderer::draw_sharp(const DrawList& list) {
  take_samples(stage_.samples);
  const StageCover::Frame cover = cover_.at(stage_.meshes, list);
  const bool same = last_ && cover == last_->cover && list.positions == last_->list.positions &&
                    list.field == last_->list.field && list.hollow == last_->list.hollow;
  if (same && list.camera == last_->list.camera && list.marks == last_->list.marks) return last_->image;
  last_.reset();
  Moment now = {{}, cover, draw_moment(list, cover, same ? Motion::same : Motion::moved)};
  now.list.camera = list.camera;
  now.list.positions = list.positions;
  now.list.field = list.field;
  now.list.hollow = list.hollow;
  now.list.marks = list.marks;
  return last_.emplace(std::move(now)).image;
}

// Draws what is seen in an instant, without words.
Image Renderer::draw_moment(const DrawList& list, const StageCover::Frame& cover, Motion motion) {
  const double aspect = static_cast<double>(stage_.width) / stage_.height;
  const Eigen::Matrix4f view = view_matrix(list.camera, aspect, cover_.bounds().center(), cover_.reach());
  const StageLight light = {stage_.light,
                            stage_.light.to_key.normalized(),
                            list.camera,
                            linear_of(stage_.colors.background).cwiseProduct(stage_.light.background_tint),
                            linear_of(stage_.colors.ground).cwiseProduct(stage_.light.ground_tint),
                            stage_.colors.exposure,
                            rays_through(list.camera, stage_.width, stage_.height)};
  DrawZone zone(gl_, "upload");
  if (motion == Motion::moved) surfaces_->upload(stage_.meshes, list);
  zone.next("shadow map");
  for (ShadowMap* map : {shadows_.get(), rim_shadows_.get()}) {
    if (map != nullptr && motion == Motion::moved)
      map->draw(*surfaces_, stage_.meshes, cover.shadow_center, cover.shadow_radius);
  }
  zone.next("visibility");
  find_visible(view, light, list);
  zone.next("ground");
  if (ground_) {
    ground_->draw(picture_color_, view, light, *shadows_, cover, stage_.meshes, list.positions, visibility_->full());
  } else {
    clear_picture();
  }
  zone.next("bodies");
  shade(light);
  if (!list.marks.empty()) draw_marks(view, list);
  zone.next("read back");
  return read_picture();
}

// Draws the mean of pictures over the list's exposure. One sample a pixel is enough for each of them, because it lies
// in another place in each; ghosts are written into every second sample and need two. What lights and shadows cover is
// that of the frame, so that the pictures differ in what moves alone.
Image Renderer::draw_exposed(const DrawList& list) {
  last_.reset();
  take_samples(std::ranges::any_of(stage_.meshes, &DrawMesh::ghost) ? 2 : 1);
  const StageCover::Frame cover = cover_.at(stage_.meshes, list);
  const bool moves = list.exposure->open > 0;
  DrawList moment = list;
  moment.exposure.reset();
  LightSum sum;
  Motion motion = Motion::moved;
  for (const ExposureSample& sample : exposure_samples(*list.exposure, pictures_needed(stage_, list))) {
    moment.camera = camera_of(list, sample);
    if (moves) positions_of(list, sample, moment.positions);
    visibility_->move_samples(sample.in_pixel.x(), sample.in_pixel.y());
    shading_program_->use();
    shading_program_->set_pairs("sample_places", visibility_->sample_places());
    sum.add(draw_moment(moment, cover, motion));
    if (!moves) motion = Motion::same;
  }
  visibility_->move_samples(0, 0);
  shading_program_->set_pairs("sample_places", visibility_->sample_places());
  return sum.mean();
}

std::vector<PassImage> Renderer::passes(const DrawList& list, const DrawList* next,
                                        std::span<const PicturePass> asked) {
  const Visibility* seen = visibility_.get();
  if (list.exposure) {
    if (!sharp_) sharp_ = std::make_unique<Visibility>(stage_.width, stage_.height, stage_.samples, stage_.meshes);
    const double aspect = static_cast<double>(stage_.width) / stage_.height;
    sharp_->find(stage_.meshes, list.positions,
                 view_matrix(list.camera, aspect, cover_.bounds().center(), cover_.reach()),
                 nearest_seen(list.camera, cover_.bounds().center(), cover_.reach()),
                 rays_through(list.camera, stage_.width, stage_.height).up.norm());
    seen = sharp_.get();
  }
  return passes_of({stage_.meshes, list, next, *seen, stage_.width, stage_.height, ground_ != nullptr}, asked);
}

void Renderer::draw_marks(const Eigen::Matrix4f& view, const DrawList& list) {
  if (!marks_) marks_ = std::make_unique<Marks>(gl_, shaders_, stage_.width, stage_.height);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  // Vertices of a mesh lie up to a part of an element below a finer skin.
  marks_->draw(list.marks, view, *visibility_, 0.02 * cover_.largest_body());
}

// Fills the picture with the colour of the background, or with nothing.
void Renderer::clear_picture() {
  const Vec3 color = backdrop_of(stage_);
  const bool transparent = has_coverage(stage_.backdrop);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  const auto channel = [&](int k) { return transparent ? 0.0f : static_cast<float>(color[k]); };
  gl_.ClearColor(channel(0), channel(1), channel(2), transparent ? 0.0f : 1.0f);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
}

// Takes the coverage from the pixels that were read, and divides the colours by it.
void Renderer::read_coverage(Image& image) const {
  image.alpha.resize(image.rgb.size() / 3);
  for (int y = 0; y < stage_.height; ++y) {
    for (int x = 0; x < stage_.width; ++x) {
      const std::size_t to = std::size_t(y) * stage_.width + x;
      const int alpha = pixels_[4 * (std::size_t(stage_.height - 1 - y) * stage_.width + x) + 3];
      image.alpha[to] = static_cast<std::uint8_t>(alpha);
      for (std::size_t k = 3 * to; k < 3 * to + 3 && alpha > 0; ++k)
        image.rgb[k] = static_cast<std::uint8_t>(std::min(255, (255 * image.rgb[k] + alpha / 2) / alpha));
    }
  }
}

void Renderer::draw_overlays(const DrawList& list, Image& image) {
  captions_->draw(image, list, subtitles_->show(list.subtitle));
  legend_.onto(image, overlays_.legend.x, overlays_.legend.y);
  graphs_->draw(image, list.graphs);
  subtitles_->draw(image);
  if (list.headline.empty() || stage_.font.empty()) return;
  const Sticker headline = headline_of(stage_, list.headline);
  headline.onto(image, overlays_.headline.x, overlays_.headline.y);
}

Image Renderer::read_picture() {
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, picture_framebuffer_);
  // Four bytes a pixel are what the picture has, and a software rasteriser copies them as they are.
  const std::size_t width = std::size_t(stage_.width);
  pixels_.resize(4 * width * stage_.height);
  gl_.ReadPixels(0, 0, stage_.width, stage_.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  check_gl(gl_, "drawing a frame");
  Image image{stage_.width, stage_.height, std::vector<std::uint8_t>(3 * width * stage_.height)};
  for (int y = 0; y < stage_.height; ++y) {  // GL's rows begin at the bottom
    const std::uint8_t* from = &pixels_[4 * width * std::size_t(stage_.height - 1 - y)];
    std::uint8_t* to = &image.rgb[3 * width * std::size_t(y)];
    // The fourth byte of a pixel is written over by the next one, which is faster than to copy three.
    for (std::size_t x = 0; x + 1 < width; ++x) std::memcpy(to + 3 * x, from + 4 * x, 4);
    std::memcpy(to + 3 * (width - 1), from + 4 * (width - 1), 3);
  }
  if (has_coverage(stage_.backdrop)) read_coverage(image);
  return image;
}

}  // namespace supple

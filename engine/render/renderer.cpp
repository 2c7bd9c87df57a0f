#include "render/renderer.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/trace.h"
#include "render/color.h"
#include "render/view.h"

namespace supple {
namespace {

// Includes the ground below bodies that hang in the air, because their shadows fall there.
Bounds stage_bounds(const Stage& stage) {
  Bounds box;
  for (const DrawMesh& mesh : stage.meshes) {
    if (!mesh.framed) continue;
    box.include(mesh.rest.lower);
    box.include(mesh.rest.upper);
    box.include(Vec3(mesh.rest.lower.x(), std::min(0.0, mesh.rest.lower.y()), mesh.rest.lower.z()));
  }
  return box;
}

double largest_of(const Stage& stage) {
  double largest = 1e-6;
  for (const DrawMesh& mesh : stage.meshes)
    if (mesh.framed) largest = std::max(largest, mesh.rest.diagonal());
  return largest;
}

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

// As shaders/ground.frag has it far from all bodies.
Vec3 backdrop_of(const Stage& stage) {
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
      bounds_(stage_bounds(stage)),
      largest_body_(largest_of(stage)),
      tiles_(stage.width, stage.height) {
  make_targets();
  visibility_program_ = std::make_unique<Program>(gl_, shaders, "visibility", "visibility");
  shadows_ =
      std::make_unique<ShadowMap>(gl_, shaders, bounds_, largest_body_, stage_.light.to_key.normalized(), stage_.width);
  ground_ = std::make_unique<Ground>(gl_, shaders, stage_.width, stage_.height, bounds_, largest_body_);
  tile_buffer_ = std::make_unique<TileBuffer>(gl_);
  textures_ = std::make_unique<TextureBuffer>(gl_, stage_.meshes);
  make_shading_program();
  prepare_field();
  check_test_picture();
  surfaces_ = std::make_unique<SurfaceBuffers>(gl_, stage_.meshes, *textures_);
  captions_ = std::make_unique<Captions>(stage_, places_of_overlays());
  check_gl(gl_, "preparing the stage");
}

Renderer::~Renderer() {
  gl_.DeleteFramebuffers(1, &visible_framebuffer_);
  gl_.DeleteFramebuffers(1, &picture_framebuffer_);
  gl_.DeleteTextures(1, &visible_);
  gl_.DeleteTextures(1, &depth_);
  gl_.DeleteTextures(1, &color_texture_);
  gl_.DeleteBuffers(1, &color_buffer_);
  gl_.DeleteRenderbuffers(1, &picture_color_);
}

void Renderer::make_targets() {
  const auto check = [this](const char* what) {
    const GLenum status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
      throw RunError(fmt::format("the {} framebuffer is incomplete (0x{:04x})", what, status));
  };
  samples_ = stage_.samples;
  for (const GLenum limit : {GL_MAX_INTEGER_SAMPLES, GL_MAX_DEPTH_TEXTURE_SAMPLES}) {
    GLint most = 1;
    gl_.GetIntegerv(limit, &most);
    samples_ = std::min(samples_, std::max(most, 1));
  }
  gl_.GenFramebuffers(1, &visible_framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, visible_framebuffer_);
  // A multisample texture with one sample is another kind of texture, and some drivers give it four samples.
  const auto target = [this](GLuint& texture, GLenum format, GLenum meaning, GLenum attachment) {
    gl_.GenTextures(1, &texture);
    gl_.BindTexture(sample_texture(), texture);
    if (samples_ > 1) {
      gl_.TexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, samples_, format, stage_.width, stage_.height, GL_TRUE);
    } else {
      gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), stage_.width, stage_.height, 0, meaning,
                     GL_UNSIGNED_INT, nullptr);
      gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, sample_texture(), texture, 0);
  };
  target(visible_, GL_R32UI, GL_RED_INTEGER, GL_COLOR_ATTACHMENT0);
  target(depth_, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_DEPTH_ATTACHMENT);
  check("visibility");
  if (samples_ > 1) gl_.GetIntegerv(GL_SAMPLES, &samples_);  // a driver may take more than were asked for
  gl_.GenFramebuffers(1, &picture_framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_);
  gl_.GenRenderbuffers(1, &picture_color_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, picture_color_);
  gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, GL_RGBA8, stage_.width, stage_.height);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, picture_color_);
  check("picture");
}

// Makes a program that shades what the stage's meshes have and no more.
void Renderer::make_shading_program() {
  std::vector<std::string> definitions = {fmt::format("SAMPLES {}", samples_)};
  if (std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return !mesh.layers.empty(); }))
    definitions.emplace_back("PAINTED");
  if (std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return !mesh.square.empty(); }))
    definitions.emplace_back("PRINTED");
  if (stage_.field) definitions.emplace_back("FIELD");
  const bool colored =
      std::ranges::any_of(stage_.meshes, [](const DrawMesh& mesh) { return !mesh.surface_colors.empty(); });
  if (colored) definitions.emplace_back("COLORED");
  if (std::ranges::any_of(stage_.meshes, &DrawMesh::wires)) definitions.emplace_back("WIRES");
  if (shading_program_ && definitions == definitions_) return;
  definitions_ = definitions;
  shading_program_ = std::make_unique<Program>(gl_, shaders_, "tiles", "surface", definitions);
  std::vector<float> places(2 * std::size_t(samples_), 0.5f);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, visible_framebuffer_);
  for (int s = 0; s < samples_ && samples_ > 1; ++s)
    gl_.GetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(s), &places[2 * std::size_t(s)]);
  shading_program_->use();
  shading_program_->set_pairs("sample_places", places);
}

// Makes the legend, and gives the colours of the field to the shader.
void Renderer::prepare_field() {
  if (!stage_.field) return;
  legend_ = legend_of(*stage_.field, stage_.font, stage_.height);
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

// Some software rasterisers accept a multisampled framebuffer and leave it blank, without an error; a triangle drawn
// into it shows whether this one does. It is shaded by the film's own program, which takes long to compile.
void Renderer::check_test_picture() {
  DrawMesh mesh;
  mesh.triangles = {0, 1, 2};
  mesh.occlusion = {1, 1, 1};
  mesh.paint.resize(3);
  mesh.color = Vec3::Ones();
  mesh.two_sided = true;
  Stage test;
  test.meshes.push_back(mesh);
  std::swap(stage_.meshes, test.meshes);
  surfaces_ = std::make_unique<SurfaceBuffers>(gl_, stage_.meshes, *textures_);
  DrawList list;
  list.camera = {Vec3(0, 1, 3), Vec3(0, 1, 0), 30};
  list.positions = {{-9, 0, 0, 9, 0, 0, 0, 9, 0}};
  const Image image = draw(list);
  std::swap(stage_.meshes, test.meshes);
  const std::size_t center = 3 * (std::size_t(image.height / 2) * image.width + image.width / 2);
  bool blank = true;
  for (std::size_t k = 0; k < 3; ++k) blank = blank && image.rgb[center + k] < 32;
  if (blank) {
    throw RunError(
        fmt::format("{} ({}) draws blank frames with {} samples a pixel; try --set output.samples=1 or another --gl",
                    name_, context_.backend(), samples_));
  }
}

void Renderer::upload(const DrawList& list) {
  for (const auto& [m, mesh] : list.renewed) stage_.meshes[m] = mesh;
  if (!list.renewed.empty()) {
    surfaces_ = std::make_unique<SurfaceBuffers>(gl_, stage_.meshes, *textures_);
    make_shading_program();
  }
  for (const auto& [m, caption] : list.captions) {
    stage_.meshes[m].label = caption;
    captions_->renew(m, caption);
  }
  surfaces_->upload(stage_.meshes, list);
}

// Writes the number of the nearest triangle into each sample, counted from one; zero is left where there is none.
void Renderer::draw_visibility(const Eigen::Matrix4f& view) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, visible_framebuffer_);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  const GLuint none[4] = {0, 0, 0, 0};
  gl_.ClearBufferuiv(GL_COLOR, 0, none);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.Enable(GL_CLIP_DISTANCE0);  // at the ground, which is drawn on its own
  visibility_program_->use();
  visibility_program_->set("view_matrix", view);
  gl_.SampleMaski(0, 0x55555555u);
  for (std::size_t m = 0; m < stage_.meshes.size(); ++m) {
    // Closed bodies hide their far sides, which need not be drawn.
    stage_.meshes[m].two_sided ? gl_.Disable(GL_CULL_FACE) : gl_.Enable(GL_CULL_FACE);
    visibility_program_->set("first", surfaces_->first_triangle(m) + 1);
    // A ghost is written into every second sample, so that half of each pixel shows what lies behind.
    if (stage_.meshes[m].ghost) gl_.Enable(GL_SAMPLE_MASK);
    surfaces_->draw(m);
    if (stage_.meshes[m].ghost) gl_.Disable(GL_SAMPLE_MASK);
  }
  gl_.Disable(GL_CLIP_DISTANCE0);
  gl_.Disable(GL_CULL_FACE);
  gl_.Disable(GL_DEPTH_TEST);
}

void Renderer::shade(const Eigen::Matrix4f& view, const StageLight& light, const DrawList& list) {
  tiles_.clear();
  for (std::size_t m = 0; m < stage_.meshes.size(); ++m)
    tiles_.mark(list.positions[m], stage_.meshes[m].triangles, view);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  const Program& program = *shading_program_;
  program.use();
  set_light(program, light);
  int unit = surfaces_->bind(program, 0);
  shadows_->bind(program, unit++);
  unit = textures_->bind(program, unit);
  program.set_texture("visible", unit++, sample_texture(), visible_);
  program.set_texture("depths", unit++, sample_texture(), depth_);
  const DepthScale scale = depth_scale(list.camera, bounds_.center(), bounds_.diagonal() + largest_body_);
  program.set("depth_scale", Vec3(scale.factor, scale.offset, light.rays.up.norm()));
  if (stage_.field) program.set_texture("colors", unit++, GL_TEXTURE_BUFFER, color_texture_);
  program.set("wire_width", std::max(1.0, stage_.height / 720.0));
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // the samples are already weighted by their coverage
  tile_buffer_->draw(tiles_.corners());
  gl_.Disable(GL_BLEND);
}

Image Renderer::draw(const DrawList& list) {
  const double aspect = static_cast<double>(stage_.width) / stage_.height;
  const Eigen::Matrix4f view = view_matrix(list.camera, aspect, bounds_.center(), bounds_.diagonal() + largest_body_);
  if (list.colors) stage_.colors = *list.colors;
  const StageLight light = {stage_.light,
                            stage_.light.to_key.normalized(),
                            list.camera,
                            linear_of(stage_.colors.background).cwiseProduct(stage_.light.background_tint),
                            linear_of(stage_.colors.ground).cwiseProduct(stage_.light.ground_tint),
                            stage_.colors.exposure,
                            rays_through(list.camera, stage_.width, stage_.height)};
  DrawZone zone(gl_, "upload");
  upload(list);
  zone.next("shadow map");
  shadows_->draw(*surfaces_, stage_.meshes);
  zone.next("visibility");
  draw_visibility(view);
  zone.next("ground");
  if (stage_.backdrop == Backdrop::ground) {
    ground_->draw(picture_framebuffer_, view, light, *shadows_, stage_.meshes, list.positions);
  } else {
    clear_picture();
  }
  zone.next("bodies");
  shade(view, light, list);
  if (!list.marks.empty()) draw_marks(view, list);
  zone.next("read back");
  Image image = read_picture();
  zone.next("captions");
  draw_overlays(list, image);
  return image;
}

void Renderer::draw_marks(const Eigen::Matrix4f& view, const DrawList& list) {
  if (!marks_) marks_ = std::make_unique<Marks>(gl_, shaders_, stage_.width, stage_.height, samples_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  const DepthScale scale = depth_scale(list.camera, bounds_.center(), bounds_.diagonal() + largest_body_);
  // Vertices of a mesh lie up to a part of an element below a finer skin.
  marks_->draw(list.marks, view, sample_texture(), depth_, {scale.factor, scale.offset}, 0.02 * largest_body_);
}

// Fills the picture with the colour of the background, or with nothing.
void Renderer::clear_picture() {
  const Vec3 color = backdrop_of(stage_);
  const bool transparent = stage_.backdrop == Backdrop::transparent;
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

// Returns the places of what stands in the same place in all pictures, which captions leave free.
std::vector<PixelRect> Renderer::places_of_overlays() const {
  if (legend_.width() == 0) return {};
  return {legend_place(legend_, stage_.width, stage_.height)};
}

void Renderer::draw_overlays(const DrawList& list, Image& image) {
  if (captions_) captions_->draw(image, list);  // not yet on the test picture
  const PixelRect legend = legend_place(legend_, stage_.width, stage_.height);
  legend_.onto(image, legend.x, legend.y);
  if (list.headline.empty() || stage_.font.empty()) return;
  const Sticker headline = headline_of(list.headline, stage_.font, stage_.height, ink_on(stage_));
  const int margin = std::max(4, stage_.height / 45);
  headline.onto(image, margin, margin);
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
  if (stage_.backdrop == Backdrop::transparent) read_coverage(image);
  return image;
}

}  // namespace supple

// Reads the bodies.
#include <algorithm>
#include <set>

#include "base/text.h"
#include "scene/reading/model_scene.h"
#include "scene/reading/seam_reader.h"
#include "scene/reading/selection_reader.h"
#include "scene/reading/table_readers.h"

namespace supple {
Ease read_ease(const ConfigTable& table) { return table.word<Ease>({"ease", "", "how keys are joined"}, Ease::smooth); }

std::vector<MotionKey> read_keys(const ConfigTable& table, const char* turn) {
  std::vector<MotionKey> keys;
  for (const ConfigTable& row :
       table.tables({"keys", "", "the motion; before the first key and after the last it stands still"})) {
    MotionKey key;
    key.time = row.number({"t", "s", "when"}, std::nullopt, Range::at_least(0));
    key.move = row.vector({"move", "m", "displacement from rest"}, Vec3(0, 0, 0));
    key.turn_deg = row.vector({"turn_deg", "degrees", turn}, Vec3(0, 0, 0));
    if (!keys.empty() && key.time <= keys.back().time)
      row.complain("t", fmt::format("t = {:g}: keys must stand in order of time (the one before is at {:g})", key.time,
                                    keys.back().time));
    keys.push_back(key);
  }
  return keys;
}

namespace {

std::optional<AttachDef> read_attach(const ConfigTable& handle) {
  const auto table = handle.table({"attach", "", "what the vertices go with: a collider, or another body"});
  if (!table) return std::nullopt;
  AttachDef attach;
  attach.collider = table->text({"collider", "", "by its surface, where it deforms, and else as a whole"}, "");
  attach.body = table->text({"body", "", "by its surface; it does not feel what goes with it"}, "");
  attach.place = handle.place("attach");
  if (attach.collider.empty() == attach.body.empty()) table->complain("attach: either `collider` or `body`");
  return attach;
}

HandleDef read_handle(const ConfigTable& table) {
  HandleDef handle;
  handle.name = table.text({"name", "", "addresses the handle in --set and in messages"}, std::nullopt);
  handle.select = read_selection(table);
  handle.stiffness =
      table
          .number_or_word({"stiffness", "N/m",
                           "of each vertex's spring to its target; hard vertices are eliminated and follow exactly"},
                          "hard", Range::positive())
          .value_or(0);
  handle.grabs = table.has("from") || table.has("until");
  handle.from = table.number({"from", "s", "it grabs its vertices where they are then, and keys move them from there"},
                             0.0, Range::at_least(0));
  handle.until = table.number_if_given({"until", "s", "it lets go; the default is never"}, Range::positive())
                     .value_or(handle.until);
  if (handle.until <= handle.from) table.complain("until", "until: must be later than 'from'");
  if (handle.grabs && handle.stiffness <= 0)
    table.complain("stiffness", "a handle that grabs or lets go needs a number as its stiffness [N/m]");
  handle.attach = read_attach(table);
  if (handle.attach && handle.from > 0)
    table.complain("from", "from: an attached handle holds its vertices from the start");
  if (handle.attach && table.has("keys")) table.complain("keys", "keys: what the handle is attached to moves it");
  handle.ease = read_ease(table);
  handle.keys = read_keys(table, "rotation about the handle's centre: x, then y, then z");
  return handle;
}

constexpr double most_vertices = 500000;  // of a body

Eigen::Vector3i read_cells(const ConfigTable& table, const Key& key, const Vec3& fallback) {
  const Vec3 cells = table.vector(key, fallback, Range::between(1, 1000));
  if (cells != cells.array().round().matrix())
    table.complain(key.name, fmt::format("{}: must be whole numbers", key.name));
  return cells.cast<int>();
}

std::optional<BoxDef> read_box(const ConfigTable& body) {
  const auto table = body.table({"box", "", "a box cut into equal cells of six tetrahedra"});
  if (!table) return std::nullopt;
  BoxDef box;
  box.extent = table->vector({"extent", "m", "the three edges"}, std::nullopt, Range::above(0, 1e6));
  box.cells = read_cells(*table, {"cells", "", "along each edge; at most 500000 vertices in all"}, Vec3(8, 8, 8));
  const double vertices = (box.cells.cast<double>().array() + 1).prod();
  if (vertices > most_vertices)
    table->complain("cells", fmt::format("cells: would make {:.0f} vertices; at most {:.0f}", vertices, most_vertices));
  return box;
}

// Reads the grid of a cloth without a file.
void read_grid(const ConfigTable& table, ClothDef& cloth) {
  cloth.extent = table.pair({"extent", "m", "width and height of the grid"}, Range::above(0, 1e6));
  const Eigen::Vector2d cells =
      table.pair({"cells", "", "of the grid, along its width and its height"}, Range::between(1, 2000));
  if (cells != cells.array().round().matrix()) table.complain("cells", "cells: must be whole numbers");
  const double vertices = (cells.array() + 1).prod();
  if (vertices > most_vertices)
    table.complain("cells", fmt::format("cells: would make {:.0f} vertices; at most {:.0f}", vertices, most_vertices));
  cloth.cells = cells.cast<int>();
}

void read_springs(const ConfigTable& table, ClothDef& cloth) {
  cloth.stretch = table.number({"stretch", "N/m", "makes it of springs, of this stiffness along edges"}, std::nullopt,
                               Range::positive());
  cloth.shear = table.number({"shear", "N/m", "of the springs of a grid's diagonals; the default is that of its edges"},
                             cloth.mesh.empty() ? cloth.stretch : 0.0, Range::at_least(0));
  cloth.bend = table.number({"bend", "N/m", "of the springs that skip a vertex"}, 0.0, Range::at_least(0));
}

// Reads in which shape the triangles of a surface are at rest, and how its border is sewn.
void read_cut(const ConfigTable& table, ClothDef& cloth) {
  cloth.cut = table.word<ClothCut>(
      {"cut", "",
       "the shape at rest of each triangle: surface: as it lies in the file; texture: as it lies flat in the texture"},
      cloth.cut);
  cloth.cut_place = table.place("cut");
  cloth.cut_scale = table.number_if_given(
      {"cut_scale", "m",
       "of one unit of texture coordinates, on the finished body; without it the cut has the area of the surface"},
      Range::above(0, 1e6));
  cloth.sew = table.number_if_given(
      {"sew", "m", "vertices on the border of a surface that are within this distance become one"},
      Range::above(0, 1e6));
  for (const char* key : {"cut", "cut_scale", "sew"}) {
    if (table.has(key) && cloth.surface.empty())
      table.complain(key, fmt::format("{}: of a cloth with a surface; there is none here", key));
  }
  if (table.has("cut_scale") && cloth.cut != ClothCut::texture)
    table.complain("cut_scale", "cut_scale: of cut = \"texture\"; without it each triangle is at rest as it lies");
  if (cloth.cut == ClothCut::texture && cloth.grain.z() != 0)
    table.complain("grain", "grain: with cut = \"texture\" it lies in the texture, as [u, v, 0]");
}

// Reads whether a cloth bends from the shape of its file: that needs a file, and a fabric that bends.
void read_curved(const ConfigTable& table, ClothDef& cloth) {
  cloth.curved = table.boolean(
      {"curved", "", "true: it bends from the shape that the file has; false: it is flat at rest"}, false);
  if (!cloth.curved) return;
  if (!table.has("mesh") && !table.has("surface")) {
    table.complain("curved", "curved: of the triangles of a file; a grid is flat");
  } else if (!cloth.fabric) {
    table.complain("curved", "curved: of cloth with a material; springs know no shape");
  } else if (cloth.fabric->fabric.bending <= 0) {
    table.complain("curved", "curved: of a material with some bend; this one has none");
  }
}

std::optional<ClothDef> read_cloth(const ConfigTable& body) {
  const auto table = body.table({"cloth", "", "a grid, or the triangles of a file; of a material, or of springs"});
  if (!table) return std::nullopt;
  ClothDef cloth;
  cloth.mesh = table->file({"mesh", "", "the triangles of a MEDIT .mesh; without a file a grid in the plane z = 0"});
  cloth.surface = table->file(
      {"surface", "", "any triangles (OBJ, PLY, STL, glTF, OFF), open or closed; up and units of the body apply"});
  if (table->has("mesh") && table->has("surface"))
    table->complain("surface", "surface: a cloth has a mesh or a surface, not both");
  if (!cloth.mesh.empty() && cloth.mesh.extension() != ".mesh" && is_model(cloth.mesh))
    table->complain("mesh", fmt::format("mesh = '{}': is not a MEDIT .mesh; surface = '{}' reads it",
                                        cloth.mesh.filename().string(), cloth.mesh.filename().string()));
  const bool is_grid = !table->has("mesh") && !table->has("surface");
  if (is_grid) read_grid(*table, cloth);
  if (!is_grid) {
    for (const char* key : {"extent", "cells", "shear"}) {
      if (table->has(key))
        table->complain(key, fmt::format("{}: of a grid; the triangles of a file have their own", key));
    }
  }
  cloth.edge = table->number_if_given(
      {"edge", "m", "wanted length of edges: the surface gets new triangles of this size; without it they stay"},
      Range::above(0, 1e6));
  if (cloth.edge && is_grid) table->complain("edge", "edge: of the triangles of a file; a grid has its cells");
  cloth.grain = table->vector({"grain", "", "direction of the warp, in the frame of the file or grid; any length"},
                              Vec3(0, 1, 0));
  if (cloth.grain.norm() < 1e-9) table->complain("grain", "grain: must not be zero");
  read_cut(*table, cloth);
  const bool has_springs = table->has("stretch") || (table->has("bend") && !body.has("material"));
  if (has_springs) read_springs(*table, cloth);
  if (has_springs && !cloth.surface.empty())
    table->complain("stretch", "stretch: springs are of a grid or a mesh; a surface has a material");
  if (!has_springs) {
    for (const char* key : {"shear", "bend"}) {
      if (table->has(key)) table->complain(key, fmt::format("{}: of springs; here the body's material has it", key));
    }
    cloth.fabric = read_fabric(body);
  }
  read_curved(*table, cloth);
  read_seams(*table, cloth);
  return cloth;
}

// Reads the printed pattern. The default is a grid on boxes and checks on cloth.
Pattern read_pattern(const ConfigTable& table, BodyDef& body) {
  const std::string usual = "usual";
  std::vector<std::string> words = all_names<Pattern>();
  words.insert(words.begin(), usual);
  const std::string word = table.choice({"pattern", "",
                                         "printed squares that show how it is strained; usual: a grid on boxes, checks "
                                         "on cloth without colours of a file, "
                                         "else none"},
                                        usual, {words});
  body.usual_pattern = word == usual;
  if (word == usual) return body.box ? Pattern::grid : body.cloth ? Pattern::checks : Pattern::none;
  const Pattern pattern = *value_named<Pattern>(word);
  if (!body.shape.empty() && pattern != Pattern::none)
    table.complain("pattern", "pattern: shapes have layers of paint instead");
  return pattern;
}

// Reads how cloth looks.
void read_cloth_look(const ConfigTable& table, BodyDef& body) {
  body.back_color = table.color_if_given(
      {"back_color", "sRGB", "of the back of cloth; a darker and paler tone of the front's where there is none"});
  body.yarn = table.number_if_given(
      {"yarn", "m",
       "from one yarn of cloth to the next; a 700th of its diagonal, of surfaces and elastic sheets 0: none are seen"},
      Range::at_least(0));
  for (const char* key : {"back_color", "yarn"}) {
    if (table.has(key) && !body.cloth) table.complain(key, fmt::format("{}: of cloth; this body is none", key));
  }
}

// Reads what the body does with others. Whether the names are those of bodies is known once all have been read
// (meeting_check.h).
BodyContactDef read_body_contact(const ConfigTable& body) {
  BodyContactDef contact;
  const auto table = body.table({"contact", "", "with other bodies, with itself and with colliders"});
  if (!table) return contact;
  const auto meets = table->boolean_or_texts(
      {"meets", "",
       "which bodies it touches and pushes: all, none or these alone; two bodies meet where both allow it"},
      true, "names of bodies");
  if (const auto* names = std::get_if<std::vector<std::string>>(&meets)) {
    contact.meets = *names;
  } else if (!std::get<bool>(meets)) {
    contact.meets.emplace();
  }
  contact.meets_place = table->place("meets");
  contact.skin = table->boolean(
      {"skin", "", "colliders are touched where its drawn skin is, and not where its elements are"}, contact.skin);
  contact.self = table->boolean({"self", "", "whether it touches itself"}, contact.self);
  contact.friction = table->number({"friction", "",
                                    "its share of Coulomb's coefficient between two bodies, which is the geometric "
                                    "mean of both; with a collider the collider's counts"},
                                   contact.friction, Range::between(0, 100));
  contact.restitution = table->number({"restitution", "",
                                       "share of its speed that it keeps at least when it bounces; the larger of those "
                                       "of the two that touch counts"},
                                      contact.restitution, Range::between(0, 1));
  return contact;
}

void refuse_substances(const ConfigTable& table, const ClothDef& cloth) {
  for (const char* key : {"material", "fibre", "regions"}) {
    if (!table.has(key) || (cloth.fabric && std::string_view(key) == "material")) continue;
    table.complain(key, cloth.fabric ? fmt::format("{}: not of cloth", key)
                                     : fmt::format("{}: not of cloth of springs, which has stretch, shear and bend in "
                                                   "its table instead",
                                                   key));
  }
}

void read_substances(const ConfigTable& table, BodyDef& body) {
  body.substance = read_substance(table);
  const auto regions = table.table({"regions", "", "materials of tagged parts, by the name of the tag"});
  if (!regions) return;
  for (const std::string& name : regions->keys()) {
    const auto region = regions->table({name.c_str(), "", "a tagged part"});
    if (region) body.regions.push_back({name, read_substance(*region), regions->place(name.c_str())});
  }
}

// Refuses names that paths and files cannot have. Files are named after bodies, with up to 16 additional bytes, and
// file systems allow 255 bytes.
void check_name(const ConfigTable& table, const std::string& name) {
  constexpr std::size_t longest = 200;
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (std::any_of(name.begin(), name.end(), is_control)) {
    table.complain("name", "name: must be a word without control characters, spaces, dots and slashes");
  } else if (name.empty() || name.find_first_of("./\\ ") != std::string::npos) {
    table.complain("name", fmt::format("name = '{}': must be a word without spaces, dots and slashes", name));
  } else if (name.size() > longest) {
    table.complain("name", fmt::format("name: has {} bytes; files are named by it, so at most {} are allowed",
                                       name.size(), longest));
  }
}

// Reads what names the body, in messages and in pictures.
void read_name_and_label(const ConfigTable& table, BodyDef& body) {
  body.place = table.place(nullptr);
  body.name = table.text({"name", "", "addresses the body in --set and in reports"}, "body");
  check_name(table, body.name);
  body.table = body.name;
  body.meant = table.words<WarningKind>({"meant", "", "warnings about the body that need not be said"});
  body.label = table.text(
      {"label", "",
       "caption in the pictures; the default is the name, and none for a body that is alone and has no name"},
      body.name);
}

// Reads what the body is made of, and how elements are made of that.
void read_geometry(const ConfigTable& table, BodyDef& body) {
  body.shape = table.file({"shape", "", "a shape file, to be meshed here"});
  body.surface = table.file({"surface", "", "a triangle surface (OBJ, PLY, STL, glTF, OFF), to be meshed here"});
  body.mesh = table.file({"mesh", "", "a tetrahedral mesh (MEDIT .mesh, Gmsh .msh, TetGen .ele, VTK .vtk or .vtu)"});
  body.box = read_box(table);
  body.cloth = read_cloth(table);
  if (table.has("shape") + table.has("surface") + table.has("mesh") + table.has("box") + table.has("cloth") != 1)
    table.complain("a body needs exactly one of 'shape', 'surface', 'mesh', 'box' and 'cloth'");
  body.vertices = table.integer({"vertices", "",
                                 "of the tetrahedra made from a shape or a surface (within 3 %; 10 % where a surface "
                                 "is thin, 50 % where a shape is)"},
                                4000, Range::between(50, 500000));
  body.size = table.number_if_given({"size", "m", "longest side; without it the file's units are metres"},
                                    Range::above(0, 1e6));
  body.scale = table.number({"scale", "", "enlarges the body, after its units"}, 1.0, Range::above(0, 1e6));
  if (body.size && table.has("scale")) table.complain("scale", "a body has a size or a scale, not both");
  body.surface_options = read_surface_options(table);
  body.pieces = table.word<Pieces>(
      {"pieces", "",
       "of a surface: join: those that overlap or touch are one body, others have their own; largest: one of these; "
       "bodies: each has its own"},
      body.pieces);
  if (table.has("pieces") && !table.has("surface"))
    table.complain("pieces", "pieces: of a 'surface'; there is none here");
  // A thickness is given for the finished body, so the surface must get its size before it is thickened.
  if (body.surface_options.thickness > 0 && body.size) body.surface_options.size = *body.size;
  body.surface_options.thickness /= body.scale;
}

void read_place(const ConfigTable& table, BodyDef& body) {
  body.position = table.vector({"position", "m", "of the middle of the bounding box's bottom"}, Vec3(0, 0, 0));
  body.turn_deg =
      table.vector({"turn_deg", "degrees", "rotation about x, then y, then z, before it is placed"}, Vec3(0, 0, 0));
  body.table_turn_deg = body.turn_deg;
}

// Reads mass and materials.
void read_matter(const ConfigTable& table, BodyDef& body) {
  body.density = table.number_if_given(
      {"density", "kg/m^3", "mass by volume; of cloth by area [kg/m^2]; the preset's, 1000, or 0.2 for cloth"},
      Range::positive());
  body.total_mass = table.number_if_given({"total_mass", "kg", "spread evenly over the volume, or the area of cloth"},
                                          Range::positive());
  if (body.density && body.total_mass) table.complain("total_mass", "a body has a density or a total_mass, not both");
  if (body.cloth) {
    refuse_substances(table, *body.cloth);
  } else {
    read_substances(table, body);
  }
}

// Reads the state in which the film begins.
void read_beginning(const ConfigTable& table, BodyDef& body) {
  body.start = read_start(table);
  body.start_inside = table.word<StartInside>(
      {"start_inside", "",
       "when it starts inside a collider: moved out if a tenth of its size is enough, else pushed out; pushed out; or "
       "an error"},
      StartInside::move);
  body.velocity = table.vector({"velocity", "m/s", "at the start"}, Vec3(0, 0, 0));
  body.spin_deg =
      table.vector({"spin_deg", "degrees/s",
                    "at the start, about an axis through the centre of mass: its direction times the speed"},
                   Vec3(0, 0, 0));
}

void read_handles(const ConfigTable& table, BodyDef& body) {
  std::set<std::string> names;
  for (const ConfigTable& row : table.tables({"handles", "", "vertices that follow a motion from outside"})) {
    body.handles.push_back(read_handle(row));
    if (!names.insert(body.handles.back().name).second)
      row.complain("name", fmt::format("two handles named '{}'", body.handles.back().name));
  }
}

// Reads what acts on the body from outside.
void read_influences(const ConfigTable& table, BodyDef& body) {
  body.drag = read_drag(table);
  body.pressure = read_pressure(table);
  body.pressure_place = table.place("pressure");
  body.contact = read_body_contact(table);
  if (body.cloth && body.contact.restitution > 0)
    table.complain("contact", "contact.restitution is for solids: a cloth has no motion as a whole that could bounce");
  read_handles(table, body);
}

void read_looks(const ConfigTable& table, BodyDef& body) {
  body.pattern = read_pattern(table, body);
  body.pattern_size = table.number_if_given(
      {"pattern_size", "m", "edge of its squares; a sixth of the middle side, of cloth a twentieth of the longest"},
      Range::positive());
  body.color = table.color_if_given({"color", "sRGB", "over the shape's own"});
  read_cloth_look(table, body);
  body.colors = table.word<ColorSource>({"colors", "",
                                         "whose colour is drawn: usual: those of the surface's file, unless there is a "
                                         "color here; file: the file's where "
                                         "it has some; body: color"},
                                        body.colors);
  if (table.has("colors") && !table.has("surface") && !(body.cloth && !body.cloth->surface.empty()))
    table.complain("colors", "colors: of a 'surface'; there is none here");
  body.gloss = table.number_if_given({"gloss", "", "of the uncovered surface: 0 matt to 1 wet [0.25; cloth 0.08]"},
                                     Range::between(0, 1));
  body.finish = read_finish(table);
  body.skin_cells = table.number({"skin_cells", "", "cells of the drawn skin along the longest side of a shape"}, 72,
                                 Range::between(8, 400));
}

}  // namespace

BodyDef read_body(const ConfigTable& table, const SolverDef& defaults) {
  BodyDef body;
  read_name_and_label(table, body);
  read_geometry(table, body);
  read_place(table, body);
  read_matter(table, body);
  read_beginning(table, body);
  read_influences(table, body);
  body.solver = defaults;
  if (const auto solver = table.table({"solver", "", "this body's own, over the scene's"}))
    body.solver = read_solver(*solver, defaults);
  read_flow(table, body);
  read_looks(table, body);
  return body;
}

}  // namespace supple

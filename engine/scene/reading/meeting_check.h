// Checks what the bodies of a scene say of each other, once all of them have been read.
#pragma once

namespace supple {

class Config;
struct SceneDef;

// Refuses names in `contact.meets` that are not those of other bodies, and pairs that cannot meet although one of the
// bodies names the other. Problems are recorded in the config.
void check_meetings(const SceneDef& scene, Config& config);

}  // namespace supple

//! `warpath study`: what it finds, what it refuses, and that it goes on where it was stopped.

mod battery;
mod configs;
mod stops;

use std::path::Path;

/// A study of the workplace's scene that takes a second or so.
pub const CONFIG: &str = r#"title = "A card over a floor"
spp = [4, 16]
repeats = 12
seed = 3
[reference]
spp = 64
runs = 12
[[scene]]
name = "card"
file = "s.xml"
symptom = "interior lacks the silhouette"
[scene.direction.shift]
"card.translation" = [1, 0, 0]
[scene.direction.brighten]
"floor.bsdf.reflectance.value" = [1, 1, 1]
"#;

pub fn write_config(directory: &Path) {
    std::fs::write(directory.join("c.toml"), CONFIG).unwrap();
}

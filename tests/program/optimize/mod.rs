//! `warpath optimize`.

mod bad_configs;
mod convergence;
mod folders;
mod photographs;
mod ranks;
mod results;
mod resume;

use std::path::Path;

/// The pose of the workplace's card, from a rendering of it.
pub const CONFIG: &str = r#"scene = "s.xml"
steps = 6
seed = 3

[truth]
spp = 64

[[view]]
sensor = "cam"

[render]
spp = 8

[optimizer]
name = "adam"
lr = 0.02

[loss]
kind = "l2"

[output]
checkpoint_every = 1
spp = 4

[parameters."card.translation"]
start = [0.1, 0, 0]
"#;

/// Runs a configuration into a folder; what it said on stderr.
pub fn optimize(directory: &Path, config: &str, arguments: &[&str]) -> (Option<i32>, String) {
    let mut typed = vec!["optimize", config];
    typed.extend(arguments);
    let out = crate::workplace::warpath(directory, &typed);
    (out.status.code(), crate::workplace::text(&out.stderr))
}

//! Pictures are read as what they mean, whatever their format; broken ones end in one sentence.

mod broken;
mod exr;
mod formats;

use warpath::picture::{Colours, Picture, read};

/// Through a file, as users do.
fn through_file(name: &str, bytes: &[u8], colours: Colours) -> Result<Picture, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a file");
    read(&path, colours).map_err(|error| error.to_string())
}

fn auto(name: &str, bytes: &[u8]) -> Picture {
    through_file(name, bytes, Colours::Auto).unwrap_or_else(|error| panic!("{error}"))
}

fn raw(name: &str, bytes: &[u8]) -> Picture {
    through_file(name, bytes, Colours::Raw).unwrap_or_else(|error| panic!("{error}"))
}

const WIDE: [[f32; 3]; 6] = [
    [0.0, 1.0, 2.0],
    [-0.5, 0.25, 1e-3],
    [6.0e4, 3.0, 7.0],
    [0.1, 0.2, 0.3],
    [1e-7, 5.0, 0.0],
    [9.0, 8.0, 7.0],
];

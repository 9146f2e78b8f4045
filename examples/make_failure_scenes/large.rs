//! The members of the battery that are too large to keep.

use crate::case::{Case, Study};
use crate::xml::{constant, floor, ply};
use crate::{forest, meshes, shapes};
use std::error::Error;
use std::path::Path;

/// Grass of so many blades.
const BLADES: u64 = 100_000;

pub fn write(folder: &Path) -> Result<(), Box<dyn Error>> {
    let field = folder.join("meshes");
    std::fs::create_dir_all(&field)?;
    meshes::blades(BLADES).write_binary(&field.join("grass.ply"))?;
    let made = forest::write(folder, forest::TRIANGLES, &shapes::star())?;
    let grass = Case {
        body: ply(
            "obj",
            "grass",
            "true",
            r#"<scale value="1.5"/><translate z="-0.3"/>"#,
            "0.2, 0.5, 0.1",
        ) + &floor(6.0)
            + &constant("1, 1, 1"),
        moves: &[("obj.translation", "[1, 0, 0]")],
        ..Case::new(
            "T5",
            "grass_100000",
            "many silhouettes in one pixel: bias by the wrong one, or noise",
        )
    };
    std::fs::write(folder.join("grass_100000.xml"), grass.scene())?;
    let wood = Case {
        file: "forest",
        moves: &[("cam.translation", "[1, 0, 0]")],
        ..Case::new(
            "T22",
            "forest",
            "1.8 million triangles: trees of edges cost more than the picture",
        )
    };
    let study = Study {
        title: "Stability: the large members of the failure battery",
        about: "Made by make_failure_scenes, with the word large.",
        spp: "[64]",
        repeats: 24,
        reference_spp: 256,
        resolution: "16x16",
    };
    std::fs::write(folder.join("study.toml"), study.toml(&[grass, wood]))?;
    println!(
        "{}: {BLADES} blades, {made} triangles of forest",
        folder.display()
    );
    Ok(())
}

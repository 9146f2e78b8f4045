//! Makes the scenes of the figures, the same bytes each time:
//!
//! `cargo run --release --example make_paper_scenes -- [FOLDER]`
//! : the small ones, into `scenes/paper` if nothing else is said.
//!
//! `cargo run --release --example make_paper_scenes -- forest [FOLDER [TRIANGLES]]`
//! : the large one, into `out/forest`, of 1.8 million triangles.

mod chance;
mod forest;
#[path = "../shared/mesh.rs"]
mod mesh;
mod pictures;
mod scenes;
mod shapes;
mod xml;

use std::error::Error;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    if arguments.next_if(|a| a == "forest").is_some() {
        let folder = PathBuf::from(arguments.next().unwrap_or("out/forest".into()));
        let triangles = match arguments.next() {
            Some(number) => number.parse()?,
            None => forest::TRIANGLES,
        };
        let made = forest::write(&folder, triangles, &shapes::star())?;
        println!("{}: {made} triangles", folder.join("forest.xml").display());
        return Ok(());
    }
    small(&PathBuf::from(
        arguments.next().unwrap_or("scenes/paper".into()),
    ))
}

fn small(folder: &Path) -> Result<(), Box<dyn Error>> {
    let meshes = folder.join("meshes");
    std::fs::create_dir_all(&meshes)?;
    shapes::star().write_binary(&meshes.join("star.ply"))?;
    shapes::waves(6.0, 64).write_binary(&meshes.join("waves.ply"))?;
    shapes::corkscrew().write_binary(&meshes.join("corkscrew.ply"))?;
    shapes::cylinder().write_binary(&meshes.join("cylinder.ply"))?;
    pictures::sun(&folder.join("sun.exr"))?;
    pictures::tiles(&folder.join("tiles.png"))?;
    pictures::tiles_tangent(&folder.join("tiles_tangent.npy"))?;
    for scene in scenes::all() {
        std::fs::write(folder.join(format!("{}.xml", scene.name)), scene.text(128))?;
    }
    Ok(())
}

//! What a run leaves behind.

pub mod colours;
pub mod curve;
pub mod errors;
pub mod geometry;
pub mod live;
pub mod meshes;
pub mod page;
pub mod scene_xml;
mod seen;
pub mod strip;
mod surface_xml;
mod text;
mod turntable;
pub mod views;

use super::problem::Problem;
use super::run::state::State;
use super::shape::intersections;
use crate::jobs::failure::Failure;
use crate::methods::Progress;
use crate::output::{atomic, exr, png};
use crate::scene::parameters::{self, Target};
use crate::scene::{Body, Scene};
use colours::ColourDistance;
use errors::ParameterError;
use geometry::Distance;
use page::Figure;
use std::io::Write;
use std::path::Path;
use strip::Strip;
use text::plain;

/// What was written, and what it says.
#[derive(Default)]
pub struct Written {
    pub files: Vec<String>,
    pub errors: Vec<ParameterError>,
    pub distances: Vec<Distance>,
    pub colours: Vec<ColourDistance>,
    pub warnings: Vec<String>,
    /// Name and PSNR in decibels.
    pub held_out: Vec<(String, f64)>,
}

impl Written {
    /// What is known of meshes and of views that were held out, for people.
    pub fn known(&self) -> Vec<String> {
        let meshes = self.distances.iter().map(|distance| {
            format!(
                "{}: chamfer distance {:.3e}, normals {:.1}° off; {:.3e}, {:.1}° at the start",
                distance.mesh,
                distance.chamfer_end,
                distance.normal_error_end_deg,
                distance.chamfer_start,
                distance.normal_error_start_deg
            )
        });
        let colours = self.colours.iter().map(|found| {
            format!(
                "{}: {} at the same places {:.3e} off (RMS), {:.3e} at the start",
                found.mesh, found.key, found.end, found.start
            )
        });
        let views = self.held_out.iter();
        meshes
            .chain(colours)
            .chain(views.map(|(view, psnr)| format!("{view}, held out: PSNR {psnr:.2} dB")))
            .collect()
    }
}

/// Writes everything that the end of a run has to show.
pub fn finish(
    directory: &Path,
    problem: &Problem,
    state: &State,
    progress: &dyn Progress,
) -> Result<Written, Failure> {
    let mut out = Written {
        files: ["checkpoint.bin", curve::CSV, curve::SVG]
            .map(String::from)
            .to_vec(),
        errors: errors::all(problem, state),
        ..Written::default()
    };
    seen::measure(problem, state, progress, &mut out.errors)?;
    let scene = scene(problem, state)?;
    out.colours = colours::all(problem, &scene);
    out.files.extend(scene_xml::write(directory, &scene)?);
    let mut figures = Vec::new();
    strips(directory, problem, &scene, progress, &mut out, &mut figures)?;
    let mut shown = Vec::new();
    for variable in &problem.variables {
        let moved = match variable.parameter.target {
            Some(Target::Texels(t)) => {
                texture(directory, &scene, t, &mut out)?;
                continue;
            }
            Some(Target::VertexPositions(m)) => Body::of(m),
            Some(
                Target::ShapeToWorld(body)
                | Target::ShapeRotation(body)
                | Target::ShapeScale(body)
                | Target::ShapeTranslation(body),
            ) => body,
            _ => continue,
        };
        for m in moved.meshes() {
            if shown.contains(&m) {
                continue;
            }
            shown.push(m);
            let own = &scene.meshes[m];
            mesh(directory, problem, own, progress, &mut out, &mut figures)?;
        }
    }
    let known = out.known();
    let html = page::html(problem, state, &figures, &out.errors, &known, false);
    write(directory, page::NAME, html.as_bytes(), &mut out)?;
    Ok(out)
}

/// The scene as it is now.
pub fn scene(problem: &Problem, state: &State) -> Result<Scene, Failure> {
    let mut scene = problem.base.scene.clone();
    let values = state.values(problem);
    for (variable, values) in problem.variables.iter().zip(&values) {
        parameters::apply(&mut scene, &variable.parameter, values)?;
    }
    Ok(scene)
}

fn write(directory: &Path, name: &str, bytes: &[u8], out: &mut Written) -> Result<(), Failure> {
    atomic::write(&directory.join(name), |file| file.write_all(bytes))?;
    out.files.push(name.into());
    Ok(())
}

fn strips(
    directory: &Path,
    problem: &Problem,
    scene: &Scene,
    progress: &dyn Progress,
    out: &mut Written,
    figures: &mut Vec<Figure>,
) -> Result<(), Failure> {
    let all: Vec<_> = problem
        .views
        .iter()
        .chain(&problem.held_out)
        .cloned()
        .collect();
    let now = views::render(problem, scene, &all, progress)?;
    let start = views::render(problem, &problem.start, &all, progress)?;
    for (number, view) in all.iter().enumerate() {
        let (target, weights) = problem.counted(view, 1);
        let images = [&start[number], &now[number], &target];
        let strip = Strip::new(images, weights.as_deref()).png()?;
        let name = page::of_view(&view.name);
        write(directory, &name, &strip, out)?;
        let is_held_out = number >= problem.views.len();
        if is_held_out {
            let psnr = views::psnr_db(&now[number], &target, weights.as_deref());
            out.held_out.push((view.name.clone(), psnr));
        }
        let held = if is_held_out { ", held out" } else { "" };
        figures.push(Figure {
            caption: format!("{}{held}: start, now, target, difference", view.name),
            png: strip,
        });
    }
    Ok(())
}

fn texture(directory: &Path, scene: &Scene, t: usize, out: &mut Written) -> Result<(), Failure> {
    let Some(image) = surface_xml::image(scene, t) else {
        return Ok(());
    };
    let name = format!("texture-{}", plain(&scene.textures[t].key));
    let [exr_name, png_name] = ["exr", "png"].map(|kind| format!("{name}.{kind}"));
    exr::write(&directory.join(&exr_name), &image)?;
    png::write_image(&directory.join(&png_name), &image)?;
    out.files.extend([exr_name, png_name]);
    Ok(())
}

fn mesh(
    directory: &Path,
    problem: &Problem,
    mesh: &crate::scene::Mesh,
    progress: &dyn Progress,
    out: &mut Written,
    figures: &mut Vec<Figure>,
) -> Result<(), Failure> {
    let name = format!("mesh-{}", plain(&mesh.id));
    if let Some(crossing @ 1..) = intersections::count(&mesh.positions, &mesh.triangles) {
        out.warnings.push(format!(
            "{}: it passes through itself, in {crossing} pairs of triangles",
            mesh.id
        ));
    }
    let [ply, obj] = ["ply", "obj"].map(|kind| format!("{name}.{kind}"));
    meshes::ply(&directory.join(&ply), mesh, &[])?;
    meshes::obj(&directory.join(&obj), mesh)?;
    out.files.extend([ply, obj]);
    let same = |scene: &Scene| {
        scene
            .meshes
            .iter()
            .find(|other| other.id == mesh.id)
            .cloned()
    };
    if let (Some(start), Some(truth)) =
        (same(&problem.start), problem.truth.as_ref().and_then(same))
    {
        out.distances.push(geometry::distance(&start, mesh, &truth));
    }
    let pictures = problem.config.output.turntable;
    if pictures > 0 {
        let png = turntable::turntable(problem, mesh, pictures, progress)?;
        write(
            directory,
            &format!("turntable-{}.png", plain(&mesh.id)),
            &png,
            out,
        )?;
        figures.push(Figure {
            caption: format!("{}, once around", mesh.id),
            png,
        });
    }
    Ok(())
}

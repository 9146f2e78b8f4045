//! What of a mesh's pictures makes edges: who looks for edges has to know where a picture jumps.

use crate::scene::{Layout, Mesh, Relief, Scene};
use glam::{DVec3, Vec2};

/// The pictures on a mesh.
pub struct Pattern {
    /// Coordinates that are linear over texture coordinates, as (a, b, c) of a·u + b·v + c: a
    /// picture jumps where one is an integer. None if all pictures are smooth within a triangle.
    pub rulings: Vec<DVec3>,
    /// Whether any lie by texture coordinates, across whose seams they jump.
    pub by_uv: bool,
    /// Whether vertices have values, which jump where two vertices have one place.
    pub of_vertices: bool,
    /// Whether triangles have values, which jump from one to the next.
    pub of_faces: bool,
    /// Whether any turns normals: about axes along the texture coordinates, which jump where these
    /// bend.
    pub turns_normals: bool,
}

impl Pattern {
    /// `None` for a mesh without pictures.
    pub fn of(scene: &Scene, mesh: &Mesh) -> Option<Self> {
        let mut textures: Vec<usize> = scene.textures_of(mesh.material);
        textures.extend(mesh.area_light.map(|l| scene.area_lights[l].radiance));
        textures.sort_unstable();
        textures.dedup();
        let layouts = textures.iter().map(|&t| scene.textures[t].layout);
        let pictures: Vec<Layout> = layouts.filter(|l| *l != Layout::Constant).collect();
        let by_uv = pictures.iter().any(|l| l.to_uv().is_some()) && !mesh.uvs.is_empty();
        let [of_vertices, of_faces] =
            [Layout::Vertices, Layout::Faces].map(|layout| pictures.contains(&layout));
        let mut rulings: Vec<DVec3> = pictures.iter().flat_map(rulings).collect();
        let parts = scene.parts_of(mesh.material).into_iter();
        let reliefs: Vec<Relief> = parts.filter_map(|m| scene.materials[m].relief).collect();
        for Relief { texture, .. } in reliefs.iter().filter(|r| r.bumps.is_some()) {
            rulings.extend(bends(&scene.textures[*texture].layout));
        }
        let turns_normals = !reliefs.is_empty();
        (by_uv || of_vertices || of_faces || turns_normals).then_some(Self {
            rulings,
            by_uv,
            of_vertices,
            of_faces,
            turns_normals,
        })
    }
}

/// Where the slope of a filtered picture jumps: at the middles of its texels.
fn bends(layout: &Layout) -> Vec<DVec3> {
    let Layout::Bitmap {
        width,
        height,
        bilinear: true,
        ..
    } = *layout
    else {
        return Vec::new();
    };
    let lines = lines_of(layout, Vec2::new(width as f32, height as f32));
    lines.into_iter().map(|l| l - DVec3::Z * 0.5).collect()
}

fn rulings(layout: &Layout) -> Vec<DVec3> {
    let per_unit = match *layout {
        Layout::Checkerboard { .. } => Vec2::splat(2.0),
        Layout::Bitmap {
            width,
            height,
            bilinear: false,
            ..
        } => Vec2::new(width as f32, height as f32),
        _ => return Vec::new(),
    };
    lines_of(layout, per_unit)
}

/// The coordinates of a picture, so many to its unit.
fn lines_of(layout: &Layout, per_unit: Vec2) -> Vec<DVec3> {
    let Some(to_uv) = layout.to_uv() else {
        return Vec::new();
    };
    let m = to_uv.matrix2;
    let row = |x: f32, y: f32, z: f32, scale: f32| {
        DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * f64::from(scale)
    };
    vec![
        row(m.x_axis.x, m.y_axis.x, to_uv.translation.x, per_unit.x),
        row(m.x_axis.y, m.y_axis.y, to_uv.translation.y, per_unit.y),
    ]
}

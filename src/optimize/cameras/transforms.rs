//! NeRF's `transforms.json`: the cameras of Blender's exporter, of instant-ngp and of nerfstudio.

use super::found::Found;
use super::lens::{Lens, one_focal_length};
use crate::files;
use crate::jobs::failure::Failure;
use crate::output::FileError;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Camera models that are pinholes where their distortion is none.
const STRAIGHT: [&str; 6] = [
    "PINHOLE",
    "SIMPLE_PINHOLE",
    "PERSPECTIVE",
    "SIMPLE_RADIAL",
    "RADIAL",
    "OPENCV",
];

#[derive(Deserialize)]
struct Document {
    #[serde(flatten)]
    lens: LensFields,
    frames: Vec<Frame>,
}

#[derive(Deserialize)]
struct Frame {
    file_path: String,
    transform_matrix: Vec<Vec<f64>>,
    mask_path: Option<PathBuf>,
    /// Of this frame alone.
    #[serde(flatten)]
    lens: LensFields,
}

#[derive(Deserialize, Default, Clone)]
struct LensFields {
    camera_model: Option<String>,
    camera_angle_x: Option<f64>,
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    w: Option<f64>,
    h: Option<f64>,
    k1: Option<f64>,
    k2: Option<f64>,
    k3: Option<f64>,
    k4: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
}

/// Reads the cameras.
pub fn read(file: &Path) -> Result<Vec<Found>, Failure> {
    let bytes = files::read(file).map_err(|error| FileError::unread(file, &error))?;
    let wrong = |what: String| Failure::Input(format!("{}: {what}", file.display()));
    let document: Document = serde_json::from_slice(&bytes).map_err(|error| {
        Failure::Input(format!(
            "{}:{}:{}: not a transforms.json: {error}",
            file.display(),
            error.line(),
            error.column()
        ))
    })?;
    if document.frames.is_empty() {
        return Err(wrong("it has no frames".into()));
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let frames = document.frames.iter().enumerate();
    frames
        .map(|(i, frame)| {
            found(frame, &document.lens, folder).map_err(|what| wrong(format!("frame {i}: {what}")))
        })
        .collect()
}

fn found(frame: &Frame, shared: &LensFields, folder: &Path) -> Result<Found, String> {
    let own = frame.lens.clone();
    let model = own.camera_model.or_else(|| shared.camera_model.clone());
    let fields = LensFields {
        camera_model: model,
        camera_angle_x: own.camera_angle_x.or(shared.camera_angle_x),
        fl_x: own.fl_x.or(shared.fl_x),
        fl_y: own.fl_y.or(shared.fl_y),
        cx: own.cx.or(shared.cx),
        cy: own.cy.or(shared.cy),
        w: own.w.or(shared.w),
        h: own.h.or(shared.h),
        k1: own.k1.or(shared.k1),
        k2: own.k2.or(shared.k2),
        k3: own.k3.or(shared.k3),
        k4: own.k4.or(shared.k4),
        p1: own.p1.or(shared.p1),
        p2: own.p2.or(shared.p2),
    };
    Ok(Found {
        named: PathBuf::from(&frame.file_path),
        to_world: to_world(&frame.transform_matrix)?,
        lens: lens(&fields)?,
        picture: picture(folder, &frame.file_path),
        mask: frame.mask_path.as_ref().map(|mask| folder.join(mask)),
    })
}

fn lens(fields: &LensFields) -> Result<Lens, String> {
    if let Some(model) = &fields.camera_model
        && !STRAIGHT.contains(&model.as_str())
    {
        return Err(format!(
            "the camera_model {model} is not supported; undistort the pictures to PINHOLE"
        ));
    }
    let bent = [
        fields.k1, fields.k2, fields.k3, fields.k4, fields.p1, fields.p2,
    ];
    if bent.iter().flatten().any(|k| *k != 0.0) {
        return Err("its lens is distorted; undistort the pictures first".into());
    }
    let size = match (fields.w, fields.h) {
        (Some(w), Some(h)) if w >= 1.0 && h >= 1.0 && w <= 65536.0 && h <= 65536.0 => {
            Some([w as u32, h as u32])
        }
        (None, None) => None,
        _ => return Err("w and h are the sides of its picture in pixels, from 1 to 65536".into()),
    };
    let focal_length_pixels = match fields.fl_x {
        Some(x) => Some(one_focal_length(x, fields.fl_y.unwrap_or(x))?),
        None => None,
    };
    if let Some(angle) = fields.camera_angle_x
        && !(angle > 0.0 && angle < std::f64::consts::PI)
    {
        return Err(format!(
            "camera_angle_x is in radians, from 0 to π, not {angle}"
        ));
    }
    if focal_length_pixels.is_none() && fields.camera_angle_x.is_none() {
        return Err("it has neither camera_angle_x nor fl_x".into());
    }
    if focal_length_pixels.is_some() && size.is_none() {
        return Err("fl_x is in pixels: w and h are needed".into());
    }
    let center = match (fields.cx, fields.cy) {
        (Some(x), Some(y)) if size.is_some() => Some(DVec2::new(x, y)),
        (None, None) => None,
        _ => return Err("cx and cy go together, with w and h".into()),
    };
    Ok(Lens {
        size,
        x_fov_rad: fields.camera_angle_x,
        focal_length_pixels,
        principal_point_pixels: center,
    })
}

/// From a camera that looks along −z with +x to the right.
fn to_world(rows: &[Vec<f64>]) -> Result<DAffine3, String> {
    let wrong = || "transform_matrix is not three or four rows of four numbers".to_string();
    if !(rows.len() == 3 || rows.len() == 4) || rows.iter().any(|row| row.len() != 4) {
        return Err(wrong());
    }
    let column = |c: usize| DVec3::new(rows[0][c], rows[1][c], rows[2][c]);
    let axes = [column(0), column(1), column(2)].map(DVec3::normalize);
    let [right, up, back] = axes;
    let skew = right
        .dot(up)
        .abs()
        .max(up.dot(back).abs())
        .max(back.dot(right).abs());
    if !skew.is_finite() || skew > 1e-3 || right.cross(up).dot(back) < 0.0 || !column(3).is_finite()
    {
        return Err("transform_matrix is not a rotation and a translation".into());
    }
    let matrix = DMat3::from_cols(-right, up, -back);
    Ok(DAffine3::from_mat3_translation(matrix, column(3)))
}

/// The file, which Blender's exporter names without its ending.
fn picture(folder: &Path, path: &str) -> PathBuf {
    let file = folder.join(path);
    match file.extension() {
        Some(_) => file,
        None => file.with_extension("png"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_where_nerf_says() {
        // The camera of a file by hand: at (0, 0, 5), unturned, so it looks down −z with +x right.
        let rows = vec![
            vec![1.0, 0.0, 0.0, 0.0],
            vec![0.0, 1.0, 0.0, 0.0],
            vec![0.0, 0.0, 1.0, 5.0],
        ];
        let to_world = to_world(&rows).unwrap();
        assert_eq!(to_world.matrix3.z_axis, DVec3::NEG_Z);
        assert_eq!(to_world.matrix3.x_axis, DVec3::NEG_X);
        assert_eq!(to_world.matrix3.y_axis, DVec3::Y);
        assert!((to_world.matrix3.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn principal_points_and_angles() {
        let fields = LensFields {
            fl_x: Some(50.0),
            cx: Some(60.0),
            cy: Some(40.0),
            w: Some(100.0),
            h: Some(80.0),
            ..LensFields::default()
        };
        let (angle, offset) = lens(&fields).unwrap().settle([100, 80]);
        assert!((angle - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!((offset.x + 0.1).abs() < 1e-6 && offset.y == 0.0);
        for wrong in [
            LensFields {
                k1: Some(0.1),
                camera_angle_x: Some(1.0),
                ..LensFields::default()
            },
            LensFields {
                fl_y: Some(60.0),
                ..fields.clone()
            },
            LensFields {
                w: None,
                h: None,
                ..fields.clone()
            },
            LensFields {
                camera_model: Some("OPENCV_FISHEYE".into()),
                ..fields.clone()
            },
            LensFields {
                k3: Some(0.1),
                ..fields.clone()
            },
            LensFields::default(),
            LensFields {
                camera_angle_x: Some(40.0),
                ..LensFields::default()
            },
        ] {
            assert!(lens(&wrong).is_err());
        }
    }
}

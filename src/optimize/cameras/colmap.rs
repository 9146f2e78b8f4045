//! COLMAP's text models: `cameras.txt` and `images.txt`.

use super::found::Found;
use super::lens::{Lens, one_focal_length};
use crate::files;
use crate::jobs::failure::Failure;
use crate::output::FileError;
use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads the cameras of a model; its pictures are in `images`, and their masks in `masks`.
pub fn read(folder: &Path, images: &Path, masks: Option<&Path>) -> Result<Vec<Found>, Failure> {
    let lenses = lines(&folder.join("cameras.txt"), |text| {
        let fields: Vec<&str> = text.split_whitespace().collect();
        let id = fields.first().copied().unwrap_or_default().to_string();
        Ok((id, lens(&fields)?))
    })?;
    let lenses: BTreeMap<String, Lens> = lenses.into_iter().collect();
    let file = folder.join("images.txt");
    // Every second line has the points of the picture, and may be empty.
    let mut is_picture = false;
    let found = lines_raw(&file, |text| {
        is_picture = !is_picture;
        match is_picture {
            true => picture(text, &lenses, [Some(images), masks]).map(Some),
            false => Ok(None),
        }
    })?;
    let found: Vec<Found> = found.into_iter().flatten().collect();
    match found.is_empty() {
        true => Err(Failure::Input(format!(
            "{}: it has no images",
            file.display()
        ))),
        false => Ok(found),
    }
}

fn lens(fields: &[&str]) -> Result<Lens, String> {
    let [_, model, width, height, parameters @ ..] = fields else {
        return Err("a camera is CAMERA_ID MODEL WIDTH HEIGHT PARAMS".into());
    };
    let side = |text: &str| match text.parse::<u32>() {
        Ok(side @ 1..=65536) => Ok(side),
        _ => Err(format!("{text} is no number of pixels")),
    };
    let numbers: Vec<f64> = parameters
        .iter()
        .map(|text| text.parse().map_err(|_| format!("{text} is no number")))
        .collect::<Result<_, _>>()?;
    let plain = |distortion: &[f64]| match distortion.iter().all(|k| *k == 0.0) {
        true => Ok(()),
        false => {
            Err("its lens is distorted; undistort the pictures first (colmap image_undistorter)")
        }
    };
    let (focal, center) = match (*model, numbers.as_slice()) {
        ("SIMPLE_PINHOLE", [f, x, y]) => (one_focal_length(*f, *f)?, [*x, *y]),
        ("PINHOLE", [fx, fy, x, y]) => (one_focal_length(*fx, *fy)?, [*x, *y]),
        ("SIMPLE_RADIAL" | "RADIAL", [f, x, y, distortion @ ..]) if !distortion.is_empty() => {
            plain(distortion)?;
            (one_focal_length(*f, *f)?, [*x, *y])
        }
        ("OPENCV", [fx, fy, x, y, distortion @ ..]) if distortion.len() == 4 => {
            plain(distortion)?;
            (one_focal_length(*fx, *fy)?, [*x, *y])
        }
        ("SIMPLE_PINHOLE" | "PINHOLE" | "SIMPLE_RADIAL" | "RADIAL" | "OPENCV", _) => {
            return Err(format!("{model} has another number of parameters"));
        }
        _ => {
            return Err(format!(
                "the camera model {model} is not supported; undistort the pictures to PINHOLE (colmap image_undistorter)"
            ));
        }
    };
    Ok(Lens {
        size: Some([side(width)?, side(height)?]),
        x_fov_rad: None,
        focal_length_pixels: Some(focal),
        principal_point_pixels: Some(DVec2::from(center)),
    })
}

fn picture(
    text: &str,
    lenses: &BTreeMap<String, Lens>,
    [images, masks]: [Option<&Path>; 2],
) -> Result<Found, String> {
    let fields: Vec<&str> = text.split_whitespace().collect();
    let wrong = "an image is IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME";
    let [_, pose @ .., camera, name] = fields.as_slice() else {
        return Err(wrong.into());
    };
    let pose: Vec<f64> = pose
        .iter()
        .map(|text| {
            text.parse()
                .map_err(|_| format!("{text} is no number; {wrong}"))
        })
        .collect::<Result<_, _>>()?;
    let [w, x, y, z, tx, ty, tz] = pose[..] else {
        return Err(wrong.into());
    };
    let turn = DQuat::from_xyzw(x, y, z, w);
    if !turn.is_finite() || turn.length() <= 1e-6 {
        return Err("its quaternion has no length".into());
    }
    let lens = lenses
        .get(*camera)
        .ok_or_else(|| format!("cameras.txt has no camera {camera}"))?;
    let named = Path::new(name);
    Ok(Found {
        named: named.into(),
        to_world: to_world(turn.normalize(), DVec3::new(tx, ty, tz)),
        lens: *lens,
        picture: images.unwrap_or(Path::new("")).join(named),
        mask: masks.map(|masks| mask(masks, name)),
    })
}

/// The mask of a/b.jpg is a/b.jpg.png, as COLMAP has it, or a/b.png.
fn mask(masks: &Path, name: &str) -> PathBuf {
    let full = masks.join(format!("{name}.png"));
    match full.exists() {
        true => full,
        false => masks.join(name).with_extension("png"),
    }
}

/// From world to camera, +x to the right and +y down, as COLMAP has it.
fn to_world(turn: DQuat, translation: DVec3) -> DAffine3 {
    let back = DMat3::from_quat(turn.inverse());
    let matrix = DMat3::from_cols(-back.x_axis, -back.y_axis, back.z_axis);
    DAffine3::from_mat3_translation(matrix, -(back * translation))
}

/// What each line but comments and empty ones says.
fn lines<T>(file: &Path, read: impl FnMut(&str) -> Result<T, String>) -> Result<Vec<T>, Failure> {
    each(file, true, read)
}

/// The same, empty lines among them.
fn lines_raw<T>(
    file: &Path,
    read: impl FnMut(&str) -> Result<T, String>,
) -> Result<Vec<T>, Failure> {
    each(file, false, read)
}

fn each<T>(
    file: &Path,
    skips_empty: bool,
    mut read: impl FnMut(&str) -> Result<T, String>,
) -> Result<Vec<T>, Failure> {
    let bytes = files::read(file).map_err(|error| FileError::unread(file, &error))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut out = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.starts_with('#') || skips_empty && line.trim().is_empty() {
            continue;
        }
        let said = read(line).map_err(|what| {
            Failure::Input(format!("{}:{}:1: {what}", file.display(), number + 1))
        })?;
        out.push(said);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_where_colmap_says() {
        // Unturned at the origin it looks along +z with +y down; a point is moved by t first.
        let plain = to_world(DQuat::IDENTITY, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(plain.translation, DVec3::new(-1.0, -2.0, -3.0));
        assert_eq!(plain.matrix3.z_axis, DVec3::Z);
        assert_eq!(plain.matrix3.y_axis, DVec3::NEG_Y);
        assert_eq!(plain.matrix3.x_axis, DVec3::NEG_X);
        // A point that COLMAP's camera sees straight ahead is straight ahead here.
        let turn = DQuat::from_xyzw(0.1, -0.4, 0.3, 0.8).normalize();
        let t = DVec3::new(0.5, -0.2, 2.0);
        let camera = to_world(turn, t);
        let ahead = camera.translation + 3.0 * camera.matrix3.z_axis;
        let seen = turn * ahead + t;
        assert!(
            (seen - DVec3::new(0.0, 0.0, 3.0)).length() < 1e-12,
            "{seen}"
        );
        let above = turn * (ahead + camera.matrix3.y_axis) + t;
        assert!(above.y < seen.y);
    }

    #[test]
    fn a_model_is_read() {
        let directory = tempfile::tempdir().unwrap();
        let at = directory.path();
        let cameras =
            "# comment\n1 PINHOLE 200 100 150 150 90 50\n\n2 SIMPLE_RADIAL 10 10 9 5 5 0\n";
        std::fs::write(at.join("cameras.txt"), cameras).unwrap();
        let images =
            "# comment\n1 1 0 0 0 0 0 0 1 a/b.png\n1.5 2.5 -1\n2 1 0 0 0 0 0 0 2 c.jpg\n\n";
        std::fs::write(at.join("images.txt"), images).unwrap();
        let found = read(at, Path::new("pictures"), Some(Path::new("masks"))).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].picture, Path::new("pictures/a/b.png"));
        assert_eq!(found[1].mask.as_deref(), Some(Path::new("masks/c.png")));
        let (angle, offset) = found[0].lens.settle([200, 100]);
        assert!((f64::from(angle) - 2.0 * (100.0f64 / 150.0).atan()).abs() < 1e-6);
        assert!((offset.x - 0.05).abs() < 1e-6 && offset.y == 0.0);
        for (wrong, part) in [
            (
                "1 FISHEYE 200 100 150 90 50 1",
                "cameras.txt:1:1: the camera model FISHEYE",
            ),
            ("1 PINHOLE 200 100 150 170 90 50", "not square"),
            ("1 SIMPLE_RADIAL 200 100 150 90 50 0.1", "distorted"),
            ("1 PINHOLE 200 100 150", "another number"),
            ("3 PINHOLE 200 100 150 150 90 50", "no camera 1"),
        ] {
            std::fs::write(at.join("cameras.txt"), wrong).unwrap();
            let said = read(at, Path::new(""), None).err().unwrap().to_string();
            assert!(said.contains(part), "{said}");
        }
    }
}

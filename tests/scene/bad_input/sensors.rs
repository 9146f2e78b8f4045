//! Cameras and films.

use super::{Case, text};

/// `inside` stands on line 2, in the only sensor.
fn in_sensor(name: &'static str, inside: &str, says: &'static [&'static str]) -> Case {
    let scene = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\">\n{inside}</sensor></scene>"
    );
    text(name, &scene, says)
}

// One line a case, however long.
#[rustfmt::skip]
pub fn cases() -> Vec<Case> {
    let fov = "<float name=\"fov\" value=\"40\"/>";
    vec![
        in_sensor("focal length without length", "<string name=\"focal_length\" value=\"wide\"/>", &["s.xml:2:1", "50mm", "\"wide\""]),
        in_sensor("focal length of zero", "<string name=\"focal_length\" value=\"0mm\"/>", &["s.xml:2:1", "positive"]),
        in_sensor("fov and focal length", &format!("{fov}\n<string name=\"focal_length\" value=\"50mm\"/>"), &["s.xml:3:1", "not both"]),
        in_sensor("fov of 180", "<float name=\"fov\" value=\"180\"/>", &["s.xml:2:1", "between 0 and 180"]),
        in_sensor("fov axis", &format!("{fov}\n<string name=\"fov_axis\" value=\"diag\"/>"), &["s.xml:3:1", "\"diagonal\""]),
        in_sensor("scaled camera", &format!("{fov}\n<transform name=\"to_world\"><scale value=\"2\"/></transform>"), &["s.xml:3:1", "scale"]),
        in_sensor("clip planes", &format!("{fov}\n<float name=\"near_clip\" value=\"10\"/><float name=\"far_clip\" value=\"1\"/>" ), &["s.xml:3:1", "near_clip"]),
        in_sensor("near clip of zero", &format!("{fov}\n<float name=\"near_clip\" value=\"0\"/>"), &["s.xml:3:1", "greater than zero"]),
        in_sensor("two films", &format!("{fov}<film type=\"hdrfilm\"/>\n<film type=\"hdrfilm\"/>"), &["s.xml:3:1", "only one film"]),
        in_sensor("width of zero", &format!("{fov}\n<film type=\"hdrfilm\"><integer name=\"width\" value=\"0\"/></film>"), &["s.xml:3:22", "width"]),
        in_sensor("huge width", &format!("{fov}\n<film type=\"hdrfilm\"><integer name=\"width\" value=\"4000000000\"/></film>" ), &["s.xml:3:22", "65536"]),
        in_sensor("crop outside", &format!("{fov}\n<film type=\"hdrfilm\"><integer name=\"crop_offset_x\" value=\"700\"/><integer name=\"crop_width\" value=\"100\"/></film>" ), &["s.xml:3:22", "does not fit", "768"]),
        in_sensor("pixel format", &format!("{fov}\n<film type=\"hdrfilm\"><string name=\"pixel_format\" value=\"rgbb\"/></film>" ), &["s.xml:3:22", "rgbb"]),
        in_sensor("unknown filter", &format!("{fov}<film type=\"hdrfilm\">\n<rfilter type=\"lanczos\"/></film>"), &["s.xml:3:1", "lanczos"]),
        in_sensor("filter of zero width", &format!("{fov}<film type=\"hdrfilm\"><rfilter type=\"gaussian\">\n<float name=\"stddev\" value=\"0\"/></rfilter></film>" ), &["s.xml:3:1", "stddev"]),
        in_sensor("no samples", &format!("{fov}<sampler type=\"independent\">\n<integer name=\"sample_count\" value=\"0\"/></sampler>" ), &["s.xml:3:1", "sample_count"]),
    ]
}

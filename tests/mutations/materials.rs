//! Materials, textures and lights of every kind, as they are written in scenes.

use super::random::Random;

/// Numbers that an honest scene gives for a colour.
fn rgb(random: &mut Random) -> String {
    let mut number = || random.number(0.05, 0.95);
    format!("{}, {}, {}", number(), number(), number())
}

/// A colour for a slot: constant, or with `textured` a texture.
pub fn colour(name: &str, textured: bool, random: &mut Random) -> String {
    match random.below(if textured { 12 } else { 4 }) {
        0 => format!(
            r##"<srgb name="{name}" value="#{:06x}"/>"##,
            random.next() & 0xff_ffff
        ),
        1 => format!(
            r#"<spectrum name="{name}" value="{}"/>"#,
            random.number(0.1, 0.9)
        ),
        2 | 3 => format!(r#"<rgb name="{name}" value="{}"/>"#, rgb(random)),
        4..7 => checkerboard(name, ["rgb", "spectrum"][random.below(2)], random),
        _ => {
            let file = *random.pick(&["c.png", "c.exr", "c.hdr", "c.pfm", "c.jpg", "grey.png"]);
            bitmap(name, file, random)
        }
    }
}

/// A roughness.
fn alpha(textured: bool, random: &mut Random) -> String {
    match random.below(if textured { 5 } else { 3 }) {
        0 => String::new(),
        1 => format!(
            r#"<float name="alpha" value="{}"/>"#,
            random.number(0.01, 0.9)
        ),
        2 => r#"<float name="alpha_u" value="0.2"/><float name="alpha_v" value="0.2"/>"#.into(),
        3 => checkerboard("alpha", "float", random),
        _ => {
            let file = *random.pick(&["grey.png", "c.exr"]);
            bitmap("alpha", file, random)
        }
    }
}

fn checkerboard(name: &str, kind: &str, random: &mut Random) -> String {
    let mut number = || random.number(0.05, 0.95);
    format!(
        r#"<texture type="checkerboard" name="{name}"><{kind} name="color0" value="{}"/>
        <{kind} name="color1" value="{}"/>{}</texture>"#,
        number(),
        number(),
        to_uv(random)
    )
}

fn bitmap(name: &str, file: &str, random: &mut Random) -> String {
    let wrap = random.pick(&["repeat", "mirror", "clamp"]);
    let filter = random.pick(&["bilinear", "bilinear", "nearest"]);
    format!(
        r#"<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>
        <string name="wrap_mode" value="{wrap}"/><string name="filter_type" value="{filter}"/>
        <boolean name="raw" value="{}"/>{}</texture>"#,
        random.chance(40),
        to_uv(random)
    )
}

fn to_uv(random: &mut Random) -> &'static str {
    random.word(&[
        "",
        r#"<transform name="to_uv"><scale x="3" y="2"/></transform>"#,
        r#"<transform name="to_uv"><translate x="0.3"/><rotate z="1" angle="20"/></transform>"#,
    ])
}

/// A bsdf.
pub fn material(textured: bool, random: &mut Random) -> String {
    match random.below(11) {
        0 | 1 => diffuse(textured, random),
        2 => format!(
            r#"<bsdf type="conductor">{}</bsdf>"#,
            metal(textured, random)
        ),
        3 => rough("roughconductor", &metal(textured, random), textured, random),
        4 => format!(
            r#"<bsdf type="dielectric">{}</bsdf>"#,
            glass(textured, random)
        ),
        5 => rough(
            "roughdielectric",
            &glass(textured, random),
            textured,
            random,
        ),
        6 => format!(r#"<bsdf type="plastic">{}</bsdf>"#, body(textured, random)),
        7 => {
            let body = body(textured, random);
            // Its roughness is a plain number.
            rough("roughplastic", &body, false, random)
        }
        8 => r#"<bsdf type="null"/>"#.into(),
        _ => format!(
            r#"<bsdf type="twosided">{}</bsdf>"#,
            opaque(textured, random)
        ),
    }
}

fn opaque(textured: bool, random: &mut Random) -> String {
    match random.below(4) {
        0 => rough("roughconductor", &metal(textured, random), textured, random),
        1 => format!(r#"<bsdf type="plastic">{}</bsdf>"#, body(textured, random)),
        2 => {
            let metal = metal(textured, random);
            format!(r#"<bsdf type="conductor">{metal}</bsdf>"#)
        }
        _ => diffuse(textured, random),
    }
}

fn diffuse(textured: bool, random: &mut Random) -> String {
    let colour = colour("reflectance", textured, random);
    format!(r#"<bsdf type="diffuse">{colour}</bsdf>"#)
}

fn rough(plugin: &str, inside: &str, textured: bool, random: &mut Random) -> String {
    let distribution = random.pick(&["beckmann", "ggx"]);
    format!(
        r#"<bsdf type="{plugin}"><string name="distribution" value="{distribution}"/>{inside}{}</bsdf>"#,
        alpha(textured, random)
    )
}

/// A colour that may be left out.
fn perhaps(name: &str, textured: bool, random: &mut Random) -> String {
    match random.chance(40) {
        true => colour(name, textured, random),
        false => String::new(),
    }
}

fn metal(textured: bool, random: &mut Random) -> String {
    let indices = match random.below(4) {
        0 => {
            let name = random.pick(&["Au", "Cu", "Cr", "none", "Ag"]);
            format!(r#"<string name="material" value="{name}"/>"#)
        }
        1 => r#"<float name="eta" value="0.2"/><float name="k" value="3.9"/>"#.into(),
        2 => {
            r#"<rgb name="eta" value="0.2, 0.9, 1.1"/><rgb name="k" value="3.9, 2.5, 2.1"/>"#.into()
        }
        _ => colour("eta", textured, random) + &colour("k", textured, random),
    };
    indices + &perhaps("specular_reflectance", textured, random)
}

fn ior(random: &mut Random) -> &'static str {
    random.word(&[
        "",
        r#"<float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>"#,
        r#"<float name="int_ior" value="1.2"/><float name="ext_ior" value="1.6"/>"#,
        r#"<string name="int_ior" value="diamond"/>"#,
        r#"<string name="int_ior" value="water"/><string name="ext_ior" value="vacuum"/>"#,
    ])
}

fn glass(textured: bool, random: &mut Random) -> String {
    ior(random).to_string()
        + &perhaps("specular_reflectance", textured, random)
        + &perhaps("specular_transmittance", textured, random)
}

fn body(textured: bool, random: &mut Random) -> String {
    let nonlinear = format!(
        r#"<boolean name="nonlinear" value="{}"/>"#,
        random.chance(50)
    );
    ior(random).to_string()
        + &nonlinear
        + &perhaps("diffuse_reflectance", textured, random)
        + &perhaps("specular_reflectance", textured, random)
}

/// Lights that are no surfaces; at most one environment.
pub fn lights(random: &mut Random) -> String {
    let environment = match random.below(4) {
        0 => String::new(),
        1 => r#"<emitter type="constant" id="env"/>"#.into(),
        2 => format!(
            r#"<emitter type="constant" id="env"><rgb name="radiance" value="{}"/></emitter>"#,
            rgb(random)
        ),
        _ => {
            let file = random.pick(&["sky.exr", "sky.hdr", "c.png", "sky.pfm"]);
            format!(
                r#"<emitter type="envmap" id="env"><string name="filename" value="{file}"/>
                <float name="scale" value="{}"/>
                <transform name="to_world"><rotate x="1" angle="90"/></transform></emitter>"#,
                random.number(0.5, 2.0)
            )
        }
    };
    let delta = match random.below(8) {
        0 => {
            r#"<emitter type="point" id="bulb"><point name="position" x="-1" y="-1.5" z="3"/>
            <rgb name="intensity" value="14, 10, 7"/></emitter>"#
        }
        1 => {
            r#"<emitter type="directional" id="sun"><vector name="direction" x="-1" y="0.7" z="-1.2"/>
            <rgb name="irradiance" value="1, 1.2, 1.6"/></emitter>"#
        }
        2 => {
            r#"<emitter type="point"><transform name="to_world"><translate z="3"/></transform></emitter>"#
        }
        _ => "",
    };
    environment + delta
}

//! Metals, mirrors, glass and pictures on surfaces.

use crate::case::Case;
use crate::xml::{constant, floor, lamp, ply};

const COLOUR: &str = "0.25, 0.4, 0.6";

pub fn all() -> Vec<Case> {
    let mut cases = metals();
    cases.extend(textures());
    cases
}

fn plate(id: &str, transform: &str, bsdf: &str) -> String {
    format!(
        "  <shape type=\"rectangle\" id=\"{id}\">\n    <transform name=\"to_world\">{transform}</transform>\n    \
         {bsdf}\n  </shape>\n"
    )
}

const ROUGH: &str = r#"<bsdf type="twosided"><bsdf type="roughconductor"><string name="material" value="Al"/><float name="alpha" value="$alpha"/></bsdf></bsdf>"#;

fn ball(transform: &str) -> String {
    ply("obj", "ball", "false", transform, COLOUR)
}

fn lights() -> String {
    lamp(
        "light",
        r#"<scale value="0.6"/><rotate x="1" angle="-20"/><translate x="-1" y="0.3" z="4"/>"#,
        "12, 12, 11",
    ) + &constant("0.5, 0.55, 0.65")
}

// Long: scenes one after another.
fn metals() -> Vec<Case> {
    let metal = |name, defines, symptom| Case {
        file: "metal",
        body: ball(r#"<scale value="0.5"/><translate y="1" z="0.9"/>"#)
            + &plate("mirror", r#"<scale value="5"/>"#, ROUGH)
            + &lights(),
        max_depth: 3,
        origin: "0, -3, 1.8",
        target: "0, 0.6, 0",
        defaults: &[("alpha", "0.1")],
        defines,
        moves: &[("obj.translation", "[1, 0, 0]")],
        ..Case::new("T9", name, symptom)
    };
    let chain = ball(r#"<scale value="0.4"/>"#)
        + &plate(
            "left",
            r#"<scale value="2"/><rotate x="1" angle="90"/><rotate z="1" angle="80"/><translate x="-1.2" y="1"/>"#,
            ROUGH,
        )
        + &plate(
            "right",
            r#"<scale value="2"/><rotate x="1" angle="90"/><rotate z="1" angle="-70"/><translate x="1.3" y="1"/>"#,
            ROUGH,
        )
        + &constant("0.8, 0.9, 1")
        + &lamp(
            "light",
            r#"<scale value="0.6"/><translate z="3"/>"#,
            "8, 8, 8",
        );
    vec![
        metal(
            "metal_300",
            &[("alpha", "0.3")],
            "a wide lobe: kernels about its middle leave its edge out",
        ),
        metal(
            "metal_100",
            &[("alpha", "0.1")],
            "a lobe as wide as the ball looks",
        ),
        metal(
            "metal_030",
            &[("alpha", "0.03")],
            "narrow lobes: heavy tails",
        ),
        metal(
            "metal_010",
            &[("alpha", "0.01")],
            "nearly a mirror: weights explode",
        ),
        metal(
            "metal_003",
            &[("alpha", "0.003")],
            "a mirror but for its name: noise without bounds",
        ),
        Case {
            body: chain.clone(),
            max_depth: 5,
            defaults: &[("alpha", "0.05")],
            moves: &[("obj.translation", "[1, 0, 0]")],
            ..Case::new(
                "T21",
                "mirror_chain",
                "mirrors in mirrors: silhouettes behind several lobes",
            )
        },
        Case {
            body: chain
                .replace(
                    r#"<bsdf type="roughconductor">"#,
                    r#"<bsdf type="conductor">"#,
                )
                .replace(r#"<float name="alpha" value="$alpha"/>"#, ""),
            max_depth: 5,
            moves: &[("obj.translation", "[1, 0, 0]")],
            ..Case::new(
                "§5",
                "smooth_mirrors",
                "no lobe to sample: lost, or refused",
            )
        },
        Case {
            body: ball(r#"<scale value="0.5"/><translate y="1" z="0.9"/>"#)
                + &plate(
                    "mirror",
                    r#"<scale value="5"/>"#,
                    r#"<bsdf type="roughconductor"><float name="eta" value="0"/><float name="k" value="2.5"/><float name="alpha" value="0.15"/></bsdf>"#,
                )
                + &lights(),
            max_depth: 3,
            origin: "0, -3, 1.8",
            target: "0, 0.6, 0",
            moves: &[("mirror.bsdf.eta.value", "[1, 1, 1]")],
            ..Case::new(
                "found",
                "metal_eta_0",
                "metal with an index of zero: a derivative at the end of its range",
            )
        },
        Case {
            body: ball(r#"<scale value="0.6"/><translate y="1.4"/>"#)
                + r#"  <shape type="cube" id="slab">
    <transform name="to_world"><scale x="2.5" y="0.1" z="2.5"/><rotate x="1" angle="8"/></transform>
    <bsdf type="roughdielectric"><float name="int_ior" value="1.5"/><float name="alpha" value="0.05"/></bsdf>
  </shape>
"# + &lights(),
            max_depth: 4,
            moves: &[("obj.translation", "[1, 0, 0]")],
            ..Case::new("§5", "behind_glass", "seen through two rough surfaces")
        },
        Case {
            body: ball(r#"<scale value="0.5"/><translate z="0.7"/>"#)
                + &plate("floor", r#"<scale value="40"/>"#, ROUGH)
                + &constant("0.5, 0.55, 0.65"),
            max_depth: 3,
            origin: "0, -6, $height",
            target: "0, 0, 0.5",
            fov: 20.0,
            defaults: &[("alpha", "0.1"), ("height", "0.5")],
            moves: &[("obj.translation", "[1, 0, 0]")],
            file: "grazing",
            ..Case::new(
                "T10",
                "grazing_85",
                "a floor seen at 85 degrees: the horizon is in every lobe",
            )
        },
        Case {
            body: ball(r#"<scale value="0.5"/><translate z="0.7"/>"#)
                + &plate("floor", r#"<scale value="40"/>"#, ROUGH)
                + &constant("0.5, 0.55, 0.65"),
            max_depth: 3,
            origin: "0, -6, $height",
            target: "0, 0, 0.5",
            fov: 20.0,
            defaults: &[("alpha", "0.1"), ("height", "0.5")],
            defines: &[("height", "0.02")],
            moves: &[("floor.rotation", "[1, 0, 0]")],
            file: "grazing",
            ..Case::new(
                "T10",
                "grazing_floor_turns",
                "a floor seen at 89.8 degrees turns: its horizon moves over all that it mirrors",
            )
        },
    ]
}

fn textures() -> Vec<Case> {
    let textured = |texture: &str| {
        format!(
            "  <shape type=\"rectangle\" id=\"obj\">\n    <transform name=\"to_world\"><scale value=\"2\"/></transform>\n    \
             <bsdf type=\"diffuse\">{texture}</bsdf>\n  </shape>\n"
        )
    };
    let bitmap = r#"<texture type="bitmap" name="reflectance"><string name="filename" value="tiles.png"/><string name="filter_type" value="$filter"/></texture>"#;
    let checker = r#"<texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.7, 0.7, 0.65"/><rgb name="color1" value="0.1, 0.12, 0.2"/>
      <transform name="to_uv"><scale value="4"/></transform></texture>"#;
    let moving = |name, texture, symptom| Case {
        body: textured(texture) + &constant("1, 1, 1"),
        origin: "0.2, -3, 2.6",
        moves: &[("obj.translation", "[1, 0.2, 0]")],
        ..Case::new("T14", name, symptom)
    };
    vec![
        moving(
            "checker",
            checker,
            "edges of a texture are edges too: interior lacks them",
        ),
        Case {
            file: "bitmap",
            defaults: &[("filter", "bilinear")],
            defines: &[("filter", "nearest")],
            ..moving("bitmap_nearest", bitmap, "every texel has edges")
        },
        Case {
            file: "bitmap",
            defaults: &[("filter", "bilinear")],
            ..moving(
                "bitmap_bilinear",
                bitmap,
                "no edges but the picture's own: interior is nearly right",
            )
        },
        Case {
            body: plate(
                "veil",
                r#"<scale value="1"/><rotate x="1" angle="90"/><translate y="-1"/>"#,
                "<bsdf type=\"null\"/>",
            ) + &ball(r#"<scale value="0.5"/><translate z="0.5"/>"#)
                + &floor(5.0)
                + &constant("1, 1, 1"),
            max_depth: 4,
            moves: &[("obj.translation", "[1, 0, 0]")],
            ..Case::new(
                "T14",
                "null_veil",
                "what is seen behind a surface that does nothing: lost, or refused",
            )
        },
    ]
}

//! Lights, shadows and what they fall on.

use crate::case::Case;
use crate::xml::{constant, envmap, floor, lamp, ply};

const COLOUR: &str = "0.25, 0.4, 0.6";

pub fn all() -> Vec<Case> {
    let mut cases = sizes();
    cases.extend(others());
    cases
}

fn blocker(transform: &str) -> String {
    ply("obj", "cube_shared", "true", transform, COLOUR)
}

fn shadow(
    name: &'static str,
    defines: &'static [(&'static str, &'static str)],
    symptom: &'static str,
) -> Case {
    Case {
        file: "shadow_sizes",
        body: blocker(r#"<scale value="$side"/><rotate z="1" angle="20"/><translate z="1"/>"#)
            + &floor(30.0)
            + &lamp(
                "light",
                r#"<scale value="$half"/><translate x="-0.3" z="4"/>"#,
                "$power, $power, $power",
            ),
        comment: "The light has the same power at every size.",
        origin: "0, -4, 3.4",
        defaults: &[("side", "0.5"), ("half", "0.3"), ("power", "100")],
        defines,
        moves: &[("obj.translation", "[1, 0.3, 0]")],
        ..Case::new("T6", name, symptom)
    }
}

fn sizes() -> Vec<Case> {
    vec![
        shadow(
            "light_small",
            &[("half", "0.01"), ("power", "90000")],
            "a light that is nearly a point: sharp shadows, wide kernels miss them",
        ),
        shadow("light_middle", &[], "a soft shadow: interior lacks it"),
        shadow(
            "light_large",
            &[("half", "10"), ("power", "0.5")],
            "a light as large as the scene: its border is in every kernel",
        ),
        Case {
            reference_spp: Some(2048),
            ..shadow(
                "blocker_small",
                &[("side", "0.02")],
                "a shadow thinner than its penumbra: few samples meet it",
            )
        },
        shadow(
            "blocker_large",
            &[("side", "1.6")],
            "a blocker above all the floor that is seen",
        ),
    ]
}

fn others() -> Vec<Case> {
    let star_light = |transform: &str| lamp("light", transform, "40, 38, 34");
    vec![
        Case {
            body: blocker(r#"<scale value="0.6"/><rotate z="1" angle="20"/><translate z="1"/>"#)
                + &floor(5.0)
                + &star_light(r#"<scale value="0.4"/><translate x="-0.3" z="3"/>"#),
            origin: "0, -4, 3.4",
            moves: &[("floor.translation", "[0, 0, 1]")],
            ..Case::new("T7", "receiver_moves", "what the shadow falls on moves: followed points of the blocker do not")
        },
        Case {
            body: ply("obj", "slit_box", "true", r#"<translate z="1"/>"#, COLOUR)
                + &floor(6.0)
                + &lamp("light", r#"<scale value="0.2"/><translate z="1.2"/>"#, "60, 55, 50"),
            origin: "0, -4, 2.2",
            target: "0, 0, 0.4",
            moves: &[("obj.translation", "[1, 0, 0]")],
            ..Case::new("T8", "slit", "a light in a box with a slit: nearly all rays to it end on the box")
        },
        Case {
            body: ply("obj", "ball", "false", r#"<scale value="0.5"/><translate z="0.6"/>"#, COLOUR)
                + &floor(6.0)
                + &envmap("one_texel_sun.exr"),
            origin: "0, -4, 2.6",
            target: "0, 0, 0.3",
            ..Case::new("T18", "one_texel_sun", "all light from one texel: sharp shadows, and a map to sample well")
        },
        Case {
            body: ply("obj", "ball", "false", r#"<scale value="0.3"/><translate z="2.4"/>"#, "0, 0, 0").replace(
                "  </shape>",
                "    <emitter type=\"area\"><rgb name=\"radiance\" value=\"14, 13, 12\"/></emitter>\n  </shape>",
            ) + &ply("blocker", "ball", "false", r#"<scale value="0.4"/><translate z="1"/>"#, COLOUR)
                + &floor(6.0),
            origin: "0, -4, 3",
            target: "0, 0, 0.5",
            moves: &[("obj.translation", "[1, 0, 0]")],
            ..Case::new("found", "tessellated_lamp", "a lamp of 1280 triangles: each is a light of its own with its own border")
        },
        Case {
            body: ply("obj", "ball", "false", r#"<scale value="0.35"/><translate z="-0.6"/>"#, COLOUR)
                + &room()
                + &lamp("light", r#"<scale value="0.35"/><translate z="0.95"/>"#, "12, 11, 10"),
            origin: "0, -0.95, 0.1",
            target: "0, 1, -0.3",
            fov: 75.0,
            max_depth: 7,
            ..Case::new("T20", "room", "six bounces in a closed room: silhouettes seen from everywhere")
        },
        Case {
            body: blocker(r#"<scale value="0.5"/><rotate z="1" angle="20"/><translate z="1"/>"#)
                + &floor(6.0)
                + "  <emitter type=\"point\" id=\"light\"><point name=\"position\" x=\"-0.3\" y=\"0\" z=\"3\"/>\n    \
                   <rgb name=\"intensity\" value=\"12, 12, 12\"/></emitter>\n",
            origin: "0, -4, 3.4",
            ..Case::new("§5", "point_light", "sharp shadows: lost, or refused")
        },
        Case {
            body: blocker(r#"<scale value="0.5"/><rotate z="1" angle="20"/><translate z="0.9"/>"#)
                + &floor(6.0)
                + &constant("0.8, 0.9, 1"),
            origin: "0, -4, 3.4",
            moves: &[("obj.vertex_positions", "[0, 0, 1]")],
            ..Case::new("found", "sky_shadow", "shadows of a sky without a lamp")
        },
    ]
}

/// A closed box around the camera, seen from inside.
fn room() -> String {
    r#"  <shape type="cube" id="room"><boolean name="flip_normals" value="true"/>
    <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.65, 0.6"/></bsdf></bsdf>
  </shape>
"#
    .into()
}

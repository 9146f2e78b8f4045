//! Shapes and how they move: cubes, seams, corkscrews, crowds, what touches and what cuts.

use crate::case::Case;
use crate::xml::{constant, floor, lamp, ply};

const COLOUR: &str = "0.25, 0.4, 0.6";
const BEFORE: &str = r#"<scale value="0.8"/>"#;

pub fn all() -> Vec<Case> {
    let mut cases = single();
    cases.extend(several());
    cases
}

fn sky() -> String {
    constant("1, 1, 1")
}

/// A grey wall behind everything.
fn wall() -> String {
    r#"  <shape type="rectangle" id="wall">
    <transform name="to_world"><scale value="6"/><rotate x="1" angle="90"/><translate y="3"/></transform>
    <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.5, 0.3"/></bsdf></bsdf>
  </shape>
"#
    .into()
}

/// A square card that faces the camera.
fn card(id: &str, half: f64, at: &str, colour: &str) -> String {
    format!(
        r#"  <shape type="rectangle" id="{id}">
    <transform name="to_world"><scale value="{half}"/><rotate x="1" angle="90"/><rotate y="1" angle="17"/>{at}</transform>
    <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="{colour}"/></bsdf></bsdf>
  </shape>
"#
    )
}

// Long: scenes one after another.
fn single() -> Vec<Case> {
    let turn: &[(&str, &str)] = &[("obj.rotation", "[0.3, 0.2, 1]")];
    let cube = |mesh, flat| ply("obj", mesh, flat, BEFORE, COLOUR) + &wall() + &sky();
    let light = || {
        lamp(
            "light",
            r#"<scale value="0.4"/><rotate y="1" angle="25"/><translate x="-1" y="-1" z="3"/>"#,
            "40, 36, 30",
        )
    };
    vec![
        Case {
            body: ply("obj", "ball", "false", BEFORE, COLOUR) + &wall() + &sky(),
            ..Case::new(
                "T1",
                "sphere",
                "interior lacks the silhouette; all others right",
            )
        },
        Case {
            body: cube("cube_shared", "true"),
            moves: turn,
            ..Case::new(
                "T2",
                "cube_flat",
                "interior lacks the silhouette; edge samplers cull by dihedral angle",
            )
        },
        Case {
            body: cube("cube_shared", "false"),
            moves: turn,
            ..Case::new(
                "T2",
                "cube_smooth",
                "normals turn over whole sides: interior edges are no silhouettes",
            )
        },
        Case {
            body: cube("cube_seamed", "false"),
            moves: turn,
            ..Case::new(
                "T2",
                "cube_seamed",
                "vertices that only lie together are taken for borders",
            )
        },
        Case {
            body: ply("obj", "corkscrew", "false", r#"<scale value="1"/>"#, COLOUR) + &sky(),
            origin: "0, -5, 0",
            moves: &[("obj.rotation", "[0, 0, 1]")],
            ..Case::new(
                "T3",
                "corkscrew",
                "the outline slides on the object: warps that follow points are biased",
            )
        },
        Case {
            body: ply("obj", "ball", "false", BEFORE, COLOUR) + &sky(),
            moves: &[("obj.scale", "[1]")],
            ..Case::new(
                "1.5",
                "ball_grows",
                "non-rigid motion: rotations leave a bias",
            )
        },
        Case {
            body: ply("obj", "broken", "true", r#"<scale value="1.3"/>"#, COLOUR)
                + &wall()
                + &sky(),
            ..Case::new(
                "T11",
                "broken_mesh",
                "slivers, triangles of no area, twice or turned round: numbers that are none, edges that are missed",
            )
        },
        Case {
            body: ply(
                "obj",
                "cube_shared",
                "true",
                r#"<scale value="1.1"/><rotate z="1" angle="20"/><translate x="1.25" z="0.9"/>"#,
                COLOUR,
            ) + &wall()
                + &sky(),
            ..Case::new(
                "T15",
                "film_border",
                "what crosses the border of the film is clipped twice or not at all",
            )
        },
        Case {
            body: ply(
                "obj",
                "shell",
                "false",
                r#"<scale value="1.2"/><rotate x="1" angle="60"/>"#,
                COLOUR,
            ) + &wall()
                + &light()
                + &sky(),
            moves: &[("obj.rotation", "[1, 0.5, 0]")],
            // The shell turns about its own middle: an outline of facets changes faster than it
            // moves.
            reference_step: Some(0.0625),
            reference_spp: Some(16384),
            ..Case::new(
                "T19",
                "open_shell",
                "an open border and both sides to be seen",
            )
        },
        Case {
            body: ply("obj", "ball", "false", r#"<scale value="0.3"/>"#, COLOUR)
                + r#"  <shape type="cube" id="safe">
    <transform name="to_world"><scale value="0.7"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.5, 0.4"/></bsdf>
  </shape>
"# + &sky(),
            ..Case::new(
                "T23",
                "unseen",
                "what moves inside a closed box: the gradient is exactly zero",
            )
        },
        Case {
            body: ply("obj", "ball", "false", BEFORE, COLOUR) + &sky(),
            moves: &[
                ("obj.translation", "[1, 0, 0]"),
                ("cam.translation", "[1, 0, 0]"),
            ],
            ..Case::new(
                "T24",
                "with_camera",
                "what moves with the camera changes nothing: zero but for noise, and no drift",
            )
        },
    ]
}

// Long: scenes one after another.
fn several() -> Vec<Case> {
    let balls = |gap: f64| {
        ply(
            "obj",
            "ball",
            "false",
            &format!(
                r#"<scale value="0.5"/><translate x="{}"/>"#,
                -0.5 - gap / 2.0
            ),
            COLOUR,
        ) + &ply(
            "other",
            "ball",
            "false",
            &format!(
                r#"<scale value="0.5"/><translate x="{}" y="0.1"/>"#,
                0.5 + gap / 2.0
            ),
            "0.7, 0.2, 0.1",
        ) + &wall()
            + &sky()
    };
    let sideways: &[(&str, &str)] = &[("obj.translation", "[1, 0, 0]")];
    let coplanar = || {
        card("obj", 0.7, r#"<translate y="$gap"/>"#, COLOUR)
            + &card(
                "other",
                0.9,
                r#"<translate x="0.3" z="0.2"/>"#,
                "0.7, 0.2, 0.1",
            )
            + &sky()
    };
    let plane = |name, gap: &'static [(&'static str, &'static str)], symptom| Case {
        file: "coplanar",
        body: coplanar(),
        defaults: &[("gap", "0")],
        defines: gap,
        moves: sideways,
        ..Case::new("T12", name, symptom)
    };
    vec![
        Case {
            body: balls(0.004),
            moves: sideways,
            ..Case::new("T4", "nearly_touching", "two silhouettes in one kernel: bias where only one is followed")
        },
        Case {
            body: balls(-0.3),
            moves: sideways,
            ..Case::new("T13", "intersecting", "the curve where they meet is no edge of a mesh")
        },
        Case {
            body: ply("obj", "leaves", "true", r#"<scale value="1.1"/>"#, COLOUR) + &wall() + &sky(),
            moves: &[("obj.rotation", "[0, 0.2, 1]")],
            ..Case::new("found", "crossing_leaves", "leaves that pass through each other turn: where they cross, no edge is")
        },
        Case {
            body: ply("obj", "blades", "true", r#"<scale value="0.9"/><translate z="-0.3"/>"#, "0.2, 0.5, 0.1") + &floor(6.0) + &sky(),
            moves: &[("obj.translation", "[1, 0, 0]")],
            reference_spp: Some(1024),
            ..Case::new("T5", "grass", "many silhouettes in one pixel: bias by the wrong one, or noise")
        },
        Case {
            body: ply("obj", "specks", "true", r#"<scale value="1"/>"#, COLOUR) + &wall() + &sky(),
            moves: sideways,
            reference_spp: Some(2048),
            ..Case::new("found", "specks", "things of less than a pixel are found by chance")
        },
        plane("coplanar_0", &[("gap", "0")], "overlapping cards in one plane: which is seen is up to rounding"),
        plane("coplanar_1e-7", &[("gap", "-1e-7")], "less apart than single precision tells"),
        plane("coplanar_1e-4", &[("gap", "-1e-4")], "a clear order, and two edges of nearly one depth"),
        Case {
            body: card("obj", 0.5, r#"<translate x="-0.5"/>"#, COLOUR)
                + &card("other", 0.5, r#"<translate x="0.5"/>"#, "0.7, 0.2, 0.1")
                + &sky(),
            moves: sideways,
            ..Case::new("found", "adjoining_cards", "cards side by side in one plane: their edges lie upon each other")
        },
        Case {
            body: ply("obj", "cube_shared", "true", r#"<rotate z="1" angle="25"/><translate z="0.5"/>"#, COLOUR)
                + &floor(6.0)
                + &lamp("light", r#"<scale value="0.4"/><rotate y="1" angle="30"/><translate x="-1.5" y="-0.5" z="3"/>"#, "40, 38, 34"),
            origin: "0.3, -4.5, 2.6",
            target: "0, 0, 0.3",
            moves: sideways,
            ..Case::new("found", "contact_shadow", "a shadow that begins where its object stands")
        },
        Case {
            body: r#"  <shape type="rectangle" id="obj">
    <transform name="to_world"><scale value="0.7"/><rotate x="1" angle="90"/><rotate y="1" angle="17"/></transform>
    <emitter type="area"><rgb name="radiance" value="1, 1, 1"/></emitter>
  </shape>
"#
            .to_string()
                + &sky(),
            moves: sideways,
            ..Case::new("found", "equal_radiance", "as bright on both sides: a silhouette that brings nothing, zero but for rounding")
        },
    ]
}

//! The same small scene where single precision is strained.

use crate::case::Case;
use crate::xml::{constant, floor, lamp, ply};

fn scaled(
    name: &'static str,
    id: &'static str,
    defines: &'static [(&'static str, &'static str)],
    symptom: &'static str,
) -> Case {
    Case {
        file: "scaled",
        comment: "Everything is $size as large and $far away from the origin along x.",
        ..placed(id, name, symptom, defines)
    }
}

const PLACE: &str = r#"<scale value="$size"/><translate x="$far"/>"#;

fn placed(
    id: &'static str,
    name: &'static str,
    symptom: &'static str,
    defines: &'static [(&'static str, &'static str)],
) -> Case {
    let ground = floor(6.0).replace(
        r#"<scale value="6"/>"#,
        &format!(r#"<scale value="6"/>{PLACE}"#),
    );
    Case {
        body: ply(
            "obj",
            "ball",
            "false",
            &format!(r#"<scale value="0.5"/><translate z="0.8"/>{PLACE}"#),
            "0.25, 0.4, 0.6",
        ) + &ground
            + &lamp(
                "light",
                &format!(r#"<scale value="0.4"/><translate x="-0.4" z="3"/>{PLACE}"#),
                "30, 28, 26",
            ),
        origin: "$x, $y, $z",
        target: "$far, 0, 0",
        defaults: &[
            ("size", "1"),
            ("far", "0"),
            ("x", "0"),
            ("y", "-4"),
            ("z", "3"),
            ("near", "0.01"),
            ("clip", "100"),
        ],
        defines,
        moves: &[("obj.translation", "[1, 0, 0]")],
        ..Case::new(id, name, symptom)
    }
}

pub fn all() -> Vec<Case> {
    vec![
        scaled(
            "scale_1",
            "T17",
            &[],
            "nothing: the size the others are compared with",
        ),
        scaled(
            "scale_large",
            "T17",
            &[
                ("size", "1e4"),
                ("y", "-4e4"),
                ("z", "3e4"),
                ("near", "100"),
                ("clip", "1e6"),
            ],
            "constants in world units",
        ),
        scaled(
            "scale_small",
            "T17",
            &[
                ("size", "1e-4"),
                ("y", "-4e-4"),
                ("z", "3e-4"),
                ("near", "1e-6"),
                ("clip", "0.01"),
            ],
            "constants in world units",
        ),
        scaled(
            "far_origin",
            "T17",
            &[("far", "1e4"), ("x", "1e4")],
            "ten thousand units away, a position is known to a thousandth",
        ),
        Case {
            body: ply(
                "obj",
                "ball",
                "false",
                r#"<scale value="0.15"/>"#,
                "0.25, 0.4, 0.6",
            ) + &constant("1, 1, 1"),
            origin: "0, -40, 0",
            fov: 0.5,
            moves: &[("obj.translation", "[1, 0, 0.3]")],
            ..Case::new(
                "T16",
                "narrow_view",
                "a field of view of half a degree: rays that are nearly parallel",
            )
        },
    ]
}

//! The small scenes.

use crate::xml::{Scene, constant, envmap, floor, lamp, ply, star};

pub fn all() -> Vec<Scene> {
    let mut scenes = primary_and_secondary();
    scenes.extend(biased());
    scenes.extend(lights());
    scenes.extend(textures());
    scenes
}

/// Where a silhouette may lie: on the film, before a light, in a mirror, behind glass.
fn primary_and_secondary() -> Vec<Scene> {
    let mirror = r#"  <shape type="ply" id="mirror">
    <string name="filename" value="meshes/waves.ply"/>
    <bsdf type="roughconductor"><string name="material" value="Al"/><float name="alpha" value="0.01"/></bsdf>
  </shape>
"#;
    let slab = r#"  <shape type="cube" id="slab">
    <transform name="to_world"><scale x="2.5" y="0.1" z="2.5"/><rotate x="1" angle="8"/><rotate z="1" angle="12"/></transform>
    <bsdf type="roughdielectric"><float name="int_ior" value="1.5"/><float name="alpha" value="0.01"/></bsdf>
  </shape>
"#;
    let wall = r#"  <shape type="rectangle" id="wall">
    <transform name="to_world"><scale value="6"/><rotate x="1" angle="90"/><translate y="3"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.65, 0.63, 0.6"/></bsdf>
  </shape>
"#;
    vec![
        Scene {
            name: "visibility",
            comment: "A star before a wall, both in the same light from everywhere: silhouettes on the film.",
            max_depth: 2,
            fov: 30.0,
            origin: "0.3, -5, 0.4",
            target: "0, 0, 0",
            body: star(r#"<scale value="1"/>"#) + wall + &constant("1, 1, 1"),
        },
        Scene {
            name: "shadow",
            comment: "The soft shadow of a star that the camera does not see.",
            max_depth: 2,
            fov: 30.0,
            origin: "0, -3.5, 2",
            target: "0, 0, 0",
            body: star(r#"<scale value="0.5"/><translate z="2"/>"#)
                + &floor(8.0)
                + &lamp(
                    "light",
                    r#"<scale value="0.2"/><translate x="-0.15" y="0.1" z="4.5"/>"#,
                    "240, 230, 210",
                ),
        },
        Scene {
            name: "reflection",
            comment: "A star that only a wavy metal mirror shows.",
            max_depth: 3,
            fov: 32.0,
            origin: "0, -3, 1.8",
            target: "0, 0, 0",
            body: star(r#"<scale value="0.6"/><translate y="1.9" z="1.4"/>"#)
                + mirror
                + &lamp(
                    "light",
                    r#"<scale value="0.6"/><rotate x="1" angle="-20"/><translate x="-1" y="0.3" z="4.2"/>"#,
                    "12, 12, 11",
                )
                + &constant("0.5, 0.55, 0.65"),
        },
        Scene {
            name: "refraction",
            comment: "A star behind a slab of slightly rough glass that fills the picture.",
            max_depth: 4,
            fov: 30.0,
            origin: "0, -4, 0.3",
            target: "0, 0, 0",
            body: star(r#"<scale value="0.75"/><translate y="1.6"/>"#)
                + slab
                + &lamp(
                    "light",
                    r#"<scale value="0.8"/><rotate x="1" angle="-25"/><translate x="-1" y="0.9" z="4"/>"#,
                    "10, 10, 9",
                )
                + &constant("0.5, 0.55, 0.65"),
        },
    ]
}

/// Outlines that move otherwise than the points on them.
fn biased() -> Vec<Scene> {
    vec![
        Scene {
            name: "corkscrew",
            comment: "A corkscrew turns about its axis: its outline runs along it, which none of its points does.",
            max_depth: 2,
            fov: 30.0,
            origin: "0, -5, 0",
            target: "0, 0, 0",
            body: ply(
                "obj",
                "corkscrew",
                "false",
                r#"<scale value="1"/>"#,
                "0.25, 0.4, 0.6",
            ) + &constant("1, 1, 1"),
        },
        Scene {
            name: "cylinder_shadow",
            comment: "A floor that rises towards a bar: where the bar's shadow ends on it is decided by ever other \
                      points of the bar.",
            max_depth: 2,
            fov: 30.0,
            origin: "0, -3.5, 2",
            target: "0, 0, 0",
            body: ply(
                "obj",
                "cylinder",
                "false",
                r#"<scale x="0.3" y="0.3" z="0.9"/><rotate y="1" angle="90"/><rotate z="1" angle="25"/><translate z="1.7"/>"#,
                "0.25, 0.4, 0.6",
            ) + &floor(8.0)
                + &lamp(
                    "light",
                    r#"<scale value="0.2"/><rotate y="1" angle="10"/><translate x="-0.6" y="0.2" z="4.2"/>"#,
                    "210, 200, 180",
                ),
        },
    ]
}

fn lights() -> Vec<Scene> {
    let hovering = || star(r#"<scale value="0.5"/><translate z="0.75"/>"#) + &floor(5.0);
    let on = |name, comment, lights: String| Scene {
        name,
        comment,
        max_depth: 2,
        fov: 36.0,
        origin: "0, -3.6, 2.2",
        target: "0, 0, 0.3",
        body: hovering() + &lights,
    };
    vec![
        on(
            "sun",
            "A star over a floor under a sky with a sun in it.",
            envmap("sun.exr"),
        ),
        on(
            "sun_and_lamp",
            "As sun.xml, and an area light that throws a second shadow.",
            envmap("sun.exr")
                + &lamp(
                    "light",
                    r#"<scale value="0.4"/><rotate y="1" angle="25"/><translate x="-1.5" y="-0.5" z="3.2"/>"#,
                    "12, 12, 11",
                ),
        ),
        on(
            "lights",
            "A star over a floor under two lamps, which move.",
            lamp(
                "light1",
                r#"<scale value="0.3"/><rotate y="1" angle="25"/><translate x="-1.4" y="-0.4" z="3"/>"#,
                "110, 95, 70",
            ) + &lamp(
                "light2",
                r#"<scale value="0.3"/><rotate y="1" angle="-30"/><translate x="1.5" y="-0.8" z="2.8"/>"#,
                "60, 80, 110",
            ),
        ),
    ]
}

fn textures() -> Vec<Scene> {
    let ground = |half: f64, texture: &str| {
        format!(
            r#"  <shape type="rectangle" id="floor">
    <transform name="to_world"><scale value="{half}"/></transform>
    <bsdf type="diffuse">
      {texture}
    </bsdf>
  </shape>
"#
        )
    };
    let light = lamp(
        "light",
        r#"<scale value="0.5"/><rotate y="1" angle="20"/><translate x="-1.2" y="-0.5" z="3.4"/>"#,
        "50, 47, 44",
    );
    vec![
        Scene {
            name: "texture",
            comment: "A floor with a picture on it, partly in the shadow of a star. Its texels are parameters.",
            max_depth: 3,
            fov: 40.0,
            origin: "0, -3, 2.6",
            target: "0, 0, 0.1",
            body: star(r#"<scale value="0.4"/><translate x="0.3" y="0.4" z="0.6"/>"#)
                + &ground(
                    1.5,
                    r#"<texture type="bitmap" name="reflectance"><string name="filename" value="tiles.png"/></texture>"#,
                )
                + &light,
        },
        Scene {
            name: "checkerboard",
            comment: "A camera moves past a star on a checkerboard, whose squares have edges of their own.",
            max_depth: 2,
            fov: 36.0,
            origin: "0.2, -3.4, 1.6",
            target: "0, 0, 0.3",
            body: star(r#"<scale value="0.5"/><translate z="0.5"/>"#)
                + &ground(
                    4.0,
                    r#"<texture type="checkerboard" name="reflectance">
        <rgb name="color0" value="0.7, 0.7, 0.65"/><rgb name="color1" value="0.12, 0.14, 0.2"/>
        <transform name="to_uv"><scale value="8"/></transform>
      </texture>"#,
                )
                + &light,
        },
    ]
}

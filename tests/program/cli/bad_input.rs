//! Input that is bad, and places that cannot be written.

use crate::workplace::{expect, workplace};

// Long: one table, a command in each row.
#[test]
fn bad_input_is_told() {
    let directory = workplace();
    let forward = |rest: &str| format!("forward s.xml --param {rest}");
    let target = |file: &str| format!("backward s.xml --param floor.translation --target {file}");
    let adjoint = |file: &str| format!("backward s.xml --param floor.translation --adjoint {file}");
    let lines = [
        ("render nosuch.xml".into(), "nosuch.xml"),
        ("params nosuch.xml".into(), "nosuch.xml"),
        ("render a_file".into(), "a_file"),
        ("render .".into(), "."),
        (
            "render s.xml --sensor 2".into(),
            "the scene has 2 sensors, counted from 0: cam, second",
        ),
        (
            "params s.xml -s 7".into(),
            "the scene has 2 sensors, counted from 0: cam, second",
        ),
        ("render s.xml -D side=wide".into(), "wide"),
        (forward("flor.translation=1,0,0"), "floor.translation"),
        (forward("floor.translatoin=1,0,0"), "floor.translation"),
        (forward("nothing=1"), "nothing"),
        (
            forward("floor.translation=1,0"),
            "floor.translation takes 3 numbers; 2 are given",
        ),
        (
            forward("floor.translation=1,0,0,0"),
            "takes 3 numbers; 4 are given",
        ),
        (
            forward("floor.vertex_positions=1,2"),
            "takes 12 numbers (4×3), or 3 for all its rows",
        ),
        (forward("floor.faces=1"), "cannot be differentiated"),
        (forward("cam.film.size=1"), "cannot be differentiated"),
        (
            forward("second.x_fov=1"),
            "second.x_fov belongs to sensor 1",
        ),
        (
            "backward s.xml --param second.translation --target target.npy".into(),
            "choose --sensor 1",
        ),
        (
            "render s.xml --resolution 65536x65536".into(),
            "65536x65536 pixels are too many",
        ),
        (
            "render s.xml -D count=4000000".into(),
            "4000000 samples a pixel are too many",
        ),
        (
            "check s.xml --spp 1 --param floor.translation=1,0,0".into(),
            "raise --spp",
        ),
        (
            forward("floor.scale=1,2"),
            "floor.scale takes 1 number; 2 are given",
        ),
        (
            forward("floor.translation=1,0,0 --param floor.translation=0,1,0"),
            "is given twice",
        ),
        (
            forward("floor.positions=1 --param floor.vertex_positions=1"),
            "is given twice",
        ),
        (forward("floor.translation=@nosuch.npy"), "nosuch.npy"),
        (
            forward("floor.translation=@four.npy"),
            "four.npy: the shape is (4,)",
        ),
        (
            forward("floor.translation=@infinite.npy"),
            "number 0 is not finite",
        ),
        (forward("floor.translation=@text.npy"), "not a NumPy array"),
        (
            forward("floor.vertex_positions=@three.npy"),
            "floor.vertex_positions has (4, 3)",
        ),
        (
            "backward s.xml --param nothing --target target.npy".into(),
            "nothing",
        ),
        (
            "backward s.xml --param floor.scale --param floor.scale --target target.npy".into(),
            "is given twice",
        ),
        (target("nosuch.exr"), "nosuch.exr"),
        (
            target("text.exr"),
            "its contents are not what its name says",
        ),
        (
            target("photo.jpg"),
            "its contents are not what its name says",
        ),
        (
            target("small.npy"),
            "4x4 pixels, the image rendered has 8x6",
        ),
        (target("turned.npy"), "6x8 pixels"),
        (target("nan.npy"), "the pixel at x 0, y 0 is not finite"),
        (target("flat.npy"), "(144,) is not that of an image"),
        (target("short.npy"), "400 bytes"),
        (target("complex.npy"), "c8"),
        (adjoint("text.npy"), "not a NumPy array"),
        (adjoint("small.npy"), "give another picture or resolution"),
        (
            adjoint("target.npy --resolution 4x4"),
            "8x6 pixels, the image rendered has 4x4",
        ),
        (
            "check s.xml --param floor.translation=1,0".into(),
            "floor.translation takes 3 numbers; 2 are given",
        ),
    ];
    let table: Vec<(&str, i32, &str)> = lines
        .iter()
        .map(|(line, part): &(String, &str)| (line.as_str(), 3, *part))
        .collect();
    expect(directory.path(), &table);
    assert!(
        !directory.path().join("out").exists(),
        "bad input must leave nothing behind"
    );
}

#[test]
fn a_place_that_cannot_be_written_is_told_before_anything_is_traced() {
    let directory = workplace();
    expect(
        directory.path(),
        &[
            (
                "render s.xml -o a_file",
                4,
                "a_file: cannot be written into",
            ),
            ("render s.xml -o a_file/below", 4, "cannot be written into"),
            (
                "render s.xml -o /proc/warpath",
                4,
                "/proc/warpath: cannot be written into",
            ),
        ],
    );
}

/// A link to itself is there and cannot be read by anybody, as a file that one may not read cannot
/// by a user: the system's words are passed on without its number.
#[cfg(unix)]
#[test]
fn what_the_system_says_is_told_in_words() {
    let directory = workplace();
    for name in ["loop.xml", "loop.npy", "loop.png"] {
        std::os::unix::fs::symlink(name, directory.path().join(name)).unwrap();
    }
    let scene = crate::workplace::SCENE.replace(
        r#"<rgb name="reflectance" value="0.2, 0.5, 0.1"/>"#,
        r#"<texture type="bitmap" name="reflectance"><string name="filename" value="loop.png"/></texture>"#,
    );
    std::fs::write(directory.path().join("textured.xml"), scene).unwrap();
    expect(
        directory.path(),
        &[
            (
                "render loop.xml",
                4,
                "error: loop.xml: Too many levels of symbolic links\n",
            ),
            (
                "render textured.xml",
                4,
                "loop.png: Too many levels of symbolic links\n",
            ),
            (
                "render a_file/s.xml",
                3,
                "error: a_file/s.xml: no such file (Not a directory)\n",
            ),
            (
                "forward s.xml --param card.translation=@loop.npy",
                4,
                "loop.npy: Too many levels of symbolic links\n",
            ),
        ],
    );
}

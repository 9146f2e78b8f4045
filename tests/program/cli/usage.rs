//! What cannot be typed.

use crate::workplace::{expect, workplace};

// Long: one table, a command in each row.
#[test]
fn wrong_usage_is_told() {
    let directory = workplace();
    expect(
        directory.path(),
        &[
            ("", 2, "Usage"),
            ("paint s.xml", 2, "unrecognized subcommand 'paint'"),
            ("rendr s.xml", 2, "render"),
            ("bench --seconds 0", 2, "a number of seconds"),
            ("bench --triangles 20000,few", 2, "few"),
            ("bench --backend embree", 2, "--backend"),
            ("bench no.ply", 3, "no.ply"),
            ("bench no.xml", 3, "no.xml"),
            ("render", 2, "<SCENE>"),
            ("params", 2, "<SCENE>"),
            ("render s.xml t.xml", 2, "t.xml"),
            ("render s.xml --frobnicate", 2, "--frobnicate"),
            ("render s.xml --sp 4", 2, "--spp"),
            ("render s.xml --spp 0", 2, "--spp"),
            ("render s.xml --spp -3", 2, "-3"),
            ("render s.xml --spp many", 2, "many"),
            ("render s.xml --spp 5000000000", 2, "5000000000"),
            ("render s.xml --spp 4000000000", 2, "1048576"),
            ("render s.xml --spp", 2, "--spp"),
            ("render s.xml --spp 4 --spp 8", 2, "multiple times"),
            ("render s.xml --seed -1", 2, "-1"),
            ("render s.xml --seed 1.5", 2, "1.5"),
            ("render s.xml --threads 0", 2, "from 1 to 4096"),
            ("render s.xml -t x", 2, "from 1 to 4096"),
            ("render s.xml --max-depth 0", 2, "segments is black"),
            ("render s.xml --max-depth -2", 2, "-1 for no limit"),
            ("render s.xml --max-depth deep", 2, "-1 for no limit"),
            ("render s.xml --sensor first", 2, "first"),
            ("render s.xml --resolution 640", 2, "640x480"),
            ("render s.xml --resolution 0x480", 2, "65536"),
            ("render s.xml --resolution 640x", 2, "640x480"),
            ("render s.xml --resolution 640x480x3", 2, "640x480"),
            ("render s.xml --resolution 999999x1", 2, "65536"),
            (
                "render s.xml --backend optix",
                2,
                "embree, obvhs or obvhs-bvh2",
            ),
            (
                "render s.xml --backend obvhs:high",
                2,
                "fastest, very-fast, fast, medium, slow, very-slow",
            ),
            ("render s.xml --log-format xml", 2, "json"),
            ("render s.xml -D side", 2, "-D side=value"),
            ("render s.xml -D =8", 2, "-D name=value"),
            (
                "render s.xml -D side=16 -D count=4 -D side=8",
                2,
                "-D side is given twice",
            ),
            (
                "params s.xml -D side=8 -D side=8",
                2,
                "-D side is given twice",
            ),
            ("render s.xml --method reparam", 2, "--method"),
            ("forward s.xml", 2, "--param <KEY=TANGENT>"),
            (
                "forward s.xml --param floor.translation",
                2,
                "floor.translation=1,0,0",
            ),
            ("forward s.xml --param =1,0,0", 2, "key is missing"),
            (
                "forward s.xml --param floor.translation=",
                2,
                "number of the tangent is missing",
            ),
            (
                "forward s.xml --param floor.translation=1,,0",
                2,
                "number of the tangent is missing",
            ),
            (
                "forward s.xml --param floor.translation=1,a,0",
                2,
                "'a' is not a number",
            ),
            (
                "forward s.xml --param floor.translation=nan",
                2,
                "'nan' is not a finite number",
            ),
            (
                "forward s.xml --param floor.translation=1,inf,0",
                2,
                "'inf' is not a finite",
            ),
            (
                "forward s.xml --param floor.translation=1e39",
                2,
                "'1e39' is not a finite",
            ),
            (
                "forward s.xml --param floor.translation=@",
                2,
                "no file is named",
            ),
            (
                "forward s.xml --param floor.translation=1 --method magic",
                2,
                "reparam",
            ),
            ("backward s.xml --target target.npy", 2, "--param <KEY>"),
            ("backward s.xml --param floor.translation", 2, "--adjoint"),
            (
                "backward s.xml --param floor.translation=1,0,0 --target target.npy",
                2,
                "write --param floor.translation",
            ),
            (
                "backward s.xml --param floor.translation --target a.npy --adjoint b.npy",
                2,
                "cannot be used with",
            ),
            (
                "backward s.xml --param floor.translation --adjoint b.npy --loss l1",
                2,
                "cannot be used with",
            ),
            (
                "backward s.xml --param floor.translation --target a.npy --loss l3",
                2,
                "l1",
            ),
            (
                "check s.xml --param floor.translation=1 --method fd",
                2,
                "checked against",
            ),
            (
                "check s.xml --param floor.translation=1 --no-stderr",
                2,
                "--no-stderr",
            ),
            (
                "check s.xml --param floor.translation=1 --tolerance 2",
                2,
                "0.03",
            ),
            ("completions tcsh", 2, "bash"),
        ],
    );
    assert!(
        !directory.path().join("out").exists(),
        "wrong usage must leave nothing behind"
    );
}

//! A scene with what is expected to go wrong on it, and how it is written down.

use crate::xml::Scene;

/// A scene, what moves in it, and its expected symptom.
pub struct Case {
    /// Its number in the catalogue of failures, or what it was found by.
    pub id: &'static str,
    /// Of the measurement.
    pub name: &'static str,
    /// Of the file, which several cases may share with other values of its `$name`s.
    pub file: &'static str,
    pub comment: &'static str,
    /// Which methods are expected to do what.
    pub symptom: &'static str,
    pub max_depth: u32,
    pub fov: f64,
    pub origin: &'static str,
    pub target: &'static str,
    pub body: String,
    pub defines: &'static [(&'static str, &'static str)],
    /// Defaults of the file's own `$name`s.
    pub defaults: &'static [(&'static str, &'static str)],
    /// Samples of each image of the reference, where the usual ones leave it uncertain.
    pub reference_spp: Option<u32>,
    /// The wider of the reference's steps in parts of the usual one, where that is too wide.
    pub reference_step: Option<f64>,
    /// Key and tangent, each as TOML.
    pub moves: &'static [(&'static str, &'static str)],
}

impl Case {
    /// With what most have.
    pub fn new(id: &'static str, name: &'static str, symptom: &'static str) -> Self {
        Self {
            id,
            name,
            file: name,
            comment: "",
            symptom,
            max_depth: 2,
            fov: 30.0,
            origin: "0.3, -5, 1.2",
            target: "0, 0, 0",
            body: String::new(),
            defines: &[],
            defaults: &[],
            reference_spp: None,
            reference_step: None,
            moves: &[("obj.translation", "[1, 0, 0.3]")],
        }
    }

    pub fn scene(&self) -> String {
        let text = Scene {
            name: self.name,
            comment: self.comment,
            max_depth: self.max_depth,
            fov: self.fov,
            origin: self.origin,
            target: self.target,
            body: self.body.clone(),
        }
        .text(16);
        // What has a $size has clip planes of that size.
        let text = match self.defaults.iter().any(|(name, _)| *name == "near") {
            true => text
                .replace(
                    r#"name="near_clip" value="0.01""#,
                    r#"name="near_clip" value="$near""#,
                )
                .replace(
                    r#"name="far_clip" value="100""#,
                    r#"name="far_clip" value="$clip""#,
                ),
            false => text,
        };
        let defaults = self.defaults.iter();
        let defaults: String = defaults
            .map(|(name, value)| format!("  <default name=\"{name}\" value=\"{value}\"/>\n"))
            .collect();
        text.replace("  <integrator", &format!("{defaults}  <integrator"))
    }

    fn toml(&self) -> String {
        let Self { name, file, .. } = self;
        let mut text = format!(
            "\n[[scene]]\nname = \"{name}\"\nfile = \"{file}.xml\"\nsymptom = \"{}: {}\"\n",
            self.id, self.symptom
        );
        if !self.defines.is_empty() {
            let pairs = self.defines.iter().map(|(n, v)| format!("{n} = \"{v}\""));
            let pairs = pairs.collect::<Vec<_>>().join(", ");
            text += &format!("defines = {{ {pairs} }}\n");
        }
        if self.reference_spp.is_some() || self.reference_step.is_some() {
            text += "[scene.reference]\n";
        }
        if let Some(spp) = self.reference_spp {
            text += &format!("spp = {spp}\n");
        }
        if let Some(step) = self.reference_step {
            text += &format!("widest_step = {step}\n");
        }
        text += "[scene.direction.move]\n";
        for (key, tangent) in self.moves {
            text += &format!("\"{key}\" = {tangent}\n");
        }
        text
    }
}

/// How a battery is measured.
pub struct Study {
    pub title: &'static str,
    pub about: &'static str,
    pub spp: &'static str,
    pub repeats: usize,
    pub reference_spp: u32,
    pub resolution: &'static str,
}

impl Study {
    pub fn toml(&self, cases: &[Case]) -> String {
        let Self {
            title,
            about,
            spp,
            repeats,
            reference_spp,
            resolution,
        } = self;
        let scenes: String = cases.iter().map(Case::toml).collect();
        format!(
            "# Written by `cargo run --example make_failure_scenes`; change that.\n\
             title = \"{title}\"\nabout = \"{about}\"\nspp = {spp}\nrepeats = {repeats}\n\
             resolution = \"{resolution}\"\nseed = 1\n\n\
             [reference]\nspp = {reference_spp}\nruns = {repeats}\n{scenes}"
        )
    }
}

/// What each scene is for.
pub fn readme(cases: &[Case]) -> String {
    let mut text = String::from(
        "# The failure battery\n\n\
         Small scenes on which published methods of differentiable rendering are known or suspected \
         to\nbreak, made by `cargo run --release --example make_failure_scenes`, which also writes \
         this table and\n`study.toml`. All are 16×16 pixels and take `-D res=…`, `-D spp=…` and \
         `-D rfilter=box|tent|gaussian`.\n\n\
         \x20   warpath study scenes/failures/study.toml --report docs/stability.md -o out/failures\n\n\
         measures every method on all of them; what it found is in \
         [docs/stability.md](../../docs/stability.md).\nReferences are finite differences at two \
         steps, a tenth and a twentieth of a pixel of what moves\nfastest, which must agree. T1 to \
         T24 are numbers of the catalogue; the rest is what probing found\nsince. T5 and T22 with \
         all their triangles are made by the same program with the word `large`.\nT24, a target that \
         the image has reached, is `with_camera`: what moves together with the camera\nchanges \
         nothing.\n\n| | scene | what moves | expected |\n|---|---|---|---|\n",
    );
    for case in cases {
        let keys: Vec<String> = case
            .moves
            .iter()
            .map(|(key, _)| format!("`{key}`"))
            .collect();
        let defines = case.defines.iter().map(|(n, v)| format!(" `-D {n}={v}`"));
        text += &format!(
            "| {} | `{}.xml`{} | {} | {} |\n",
            case.id,
            case.file,
            defines.collect::<String>(),
            keys.join(", "),
            case.symptom
        );
    }
    text
}

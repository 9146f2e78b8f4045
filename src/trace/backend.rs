//! What can trace the rays, and how carefully it builds: the names behind `--backend`.

use std::fmt;
use std::str::FromStr;

/// A library, its kind of tree, and how carefully that is built.
///
/// Every backend has a name in every build; [`Backend::require`] says which are compiled in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Backend {
    Embree(EmbreeIsa, EmbreeQuality),
    Obvhs(ObvhsTree, ObvhsPreset),
}

/// Which instructions Embree may use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum EmbreeIsa {
    /// The best that this CPU and library have.
    #[default]
    Best,
    /// Four lanes, as obvhs's own traversal has: for comparisons.
    Sse42,
}

/// Embree's build qualities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum EmbreeQuality {
    /// Sorted by Morton codes.
    Low,
    /// Binned surface areas.
    #[default]
    Medium,
    /// Surface areas, with spatial splits.
    High,
}

/// Which of obvhs's trees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ObvhsTree {
    /// Eight children a node, compressed.
    #[default]
    Cwbvh,
    /// Two children a node.
    Bvh2,
}

/// obvhs's presets, `BvhBuildParams::…_build`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ObvhsPreset {
    Fastest,
    VeryFast,
    Fast,
    #[default]
    Medium,
    /// With spatial splits, as is `VerySlow`.
    Slow,
    VerySlow,
}

impl EmbreeQuality {
    pub const ALL: [(Self, &'static str); 3] = [
        (Self::Low, "low"),
        (Self::Medium, "medium"),
        (Self::High, "high"),
    ];
}

impl ObvhsPreset {
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Fastest, "fastest"),
        (Self::VeryFast, "very-fast"),
        (Self::Fast, "fast"),
        (Self::Medium, "medium"),
        (Self::Slow, "slow"),
        (Self::VerySlow, "very-slow"),
    ];
}

impl Default for Backend {
    /// Embree, or obvhs in a build without it.
    fn default() -> Self {
        if cfg!(feature = "embree") {
            Self::Embree(EmbreeIsa::default(), EmbreeQuality::default())
        } else {
            Self::Obvhs(ObvhsTree::default(), ObvhsPreset::default())
        }
    }
}

impl Backend {
    /// The library and what of it: `embree`, `embree-sse4.2`, `obvhs` or `obvhs-bvh2`.
    pub fn library(self) -> &'static str {
        match self {
            Self::Embree(EmbreeIsa::Best, _) => "embree",
            Self::Embree(EmbreeIsa::Sse42, _) => "embree-sse4.2",
            Self::Obvhs(ObvhsTree::Cwbvh, _) => "obvhs",
            Self::Obvhs(ObvhsTree::Bvh2, _) => "obvhs-bvh2",
        }
    }

    /// How carefully it builds.
    pub fn preset(self) -> &'static str {
        let name = match self {
            Self::Embree(_, quality) => EmbreeQuality::ALL
                .iter()
                .find(|q| q.0 == quality)
                .map(|q| q.1),
            Self::Obvhs(_, preset) => ObvhsPreset::ALL.iter().find(|p| p.0 == preset).map(|p| p.1),
        };
        name.unwrap_or_default()
    }

    /// This library and tree, at each of its presets.
    pub fn presets(self) -> Vec<Self> {
        match self {
            Self::Embree(isa, _) => EmbreeQuality::ALL.map(|q| Self::Embree(isa, q.0)).into(),
            Self::Obvhs(tree, _) => ObvhsPreset::ALL.map(|p| Self::Obvhs(tree, p.0)).into(),
        }
    }

    /// Everything that this build and machine have, as carefully built as usual.
    pub fn built_in() -> Vec<Self> {
        let sse = cfg!(target_arch = "x86_64").then_some("embree-sse4.2");
        ["embree", "obvhs", "obvhs-bvh2"]
            .into_iter()
            .chain(sse)
            .filter_map(|name| name.parse::<Self>().ok())
            .filter(|backend| backend.require().is_ok())
            .collect()
    }

    /// Says in a sentence that a backend was left out of this build, if it was.
    pub fn require(self) -> Result<(), &'static str> {
        match self {
            Self::Embree(..) if !cfg!(feature = "embree") => Err(
                "this warpath was built without Embree: use --backend obvhs, or build it with --features embree",
            ),
            Self::Obvhs(..) if !cfg!(feature = "obvhs") => Err(
                "this warpath was built without obvhs: use --backend embree, or build it with --features obvhs",
            ),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Backend {
    /// As it is typed: `embree`, `obvhs:slow`; the usual preset is not named.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Embree(_, EmbreeQuality::Medium) | Self::Obvhs(_, ObvhsPreset::Medium) => {
                f.write_str(self.library())
            }
            _ => write!(f, "{}:{}", self.library(), self.preset()),
        }
    }
}

impl FromStr for Backend {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (library, preset) = text.split_once(':').unwrap_or((text, "medium"));
        let usual = match library {
            "embree" => Self::Embree(EmbreeIsa::Best, EmbreeQuality::default()),
            "embree-sse4.2" => Self::Embree(EmbreeIsa::Sse42, EmbreeQuality::default()),
            "obvhs" => Self::Obvhs(ObvhsTree::Cwbvh, ObvhsPreset::default()),
            "obvhs-bvh2" => Self::Obvhs(ObvhsTree::Bvh2, ObvhsPreset::default()),
            _ => return Err("write embree, obvhs or obvhs-bvh2".into()),
        };
        let presets = usual.presets();
        presets
            .iter()
            .copied()
            .find(|b| b.preset() == preset)
            .ok_or_else(|| {
                let names: Vec<&str> = presets.iter().map(|b| b.preset()).collect();
                format!("{library} is built as one of {}", names.join(", "))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backends_are_read_as_they_are_written() {
        for library in ["embree", "embree-sse4.2", "obvhs", "obvhs-bvh2"] {
            let usual: Backend = library.parse().unwrap();
            assert_eq!(
                (usual.to_string().as_str(), usual.preset()),
                (library, "medium")
            );
            for backend in usual.presets() {
                assert_eq!(backend.to_string().parse(), Ok(backend));
                assert_eq!(backend.library(), library);
            }
        }
        for wrong in [
            "",
            "optix",
            "obvhs:",
            "obvhs:high",
            "embree:fastest",
            "embree-avx",
            "embree:low:low",
        ] {
            assert!(wrong.parse::<Backend>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_usual_backend_is_built_in() {
        assert_eq!(Backend::default().require(), Ok(()));
        assert!(Backend::built_in().contains(&Backend::default()));
    }
}

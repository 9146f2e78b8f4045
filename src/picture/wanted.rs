//! What a reader can say about the pixels it wants.

/// What to make of stored numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// They are colours: integers are sRGB-encoded and become linear, floating-point numbers are
    /// linear.
    #[default]
    Auto,
    /// They are data, such as normals or roughness: only divided by the largest integer.
    Raw,
}

/// How the channels of an OpenEXR file may be called.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChannelNames {
    /// R, G and B, or Y.
    #[default]
    Plain,
    /// These, large or small, or `layer.R` and so on, as renderers write them; or a single one of
    /// any name.
    WithPrefix,
}

/// What of a file's pixels is wanted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted {
    pub colours: Colours,
    pub channels: ChannelNames,
}

impl From<Colours> for Wanted {
    fn from(colours: Colours) -> Self {
        let channels = ChannelNames::default();
        Self { colours, channels }
    }
}

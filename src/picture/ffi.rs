//! The C interface of `ffi/oiio_shim.h`, and what makes it safe.

use super::error::Fault;
use crate::room;
use std::ffi::{CStr, CString, c_char};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::ptr::NonNull;

#[allow(non_camel_case_types, dead_code, missing_docs, clippy::all)]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/oiio_shim.rs"));
}

pub(super) use bindings::WarpathPictureSpec as Spec;
use bindings::{
    WarpathPicture, WarpathPictureMessage, warpath_picture_close, warpath_picture_open,
    warpath_picture_read,
};

/// A picture file that OpenImageIO has opened.
pub(super) struct Open {
    picture: NonNull<WarpathPicture>,
    pub spec: Spec,
    /// The names of the channels, where none of them is a colour.
    pub other_channels: String,
}

impl Open {
    /// Opens a file, or gives OpenImageIO's words.
    pub fn new(file: &Path) -> Result<Self, String> {
        let path = CString::new(file.as_os_str().as_bytes())
            .map_err(|_| "a file's name has no zero byte".to_string())?;
        let mut spec = Spec::default();
        let mut message = no_message();
        // SAFETY: `path` ends with a zero byte, and all three outlive the call.
        let picture = unsafe { warpath_picture_open(path.as_ptr(), &mut spec, &mut message) };
        let picture = NonNull::new(picture).ok_or_else(|| text(&message))?;
        Ok(Self {
            picture,
            spec,
            other_channels: text(&message),
        })
    }

    /// `width · height · channels` numbers, row by row from the top. The size must have been
    /// checked.
    pub fn samples(&mut self) -> Result<Vec<f32>, Fault> {
        let Spec {
            width,
            height,
            channels,
            ..
        } = self.spec;
        let count = width as usize * height as usize * channels as usize;
        let mut samples = room::filled(0.0, count)?;
        let mut message = no_message();
        // SAFETY: the picture is open, and `samples` is as long as its spec says.
        let failed = unsafe {
            warpath_picture_read(self.picture.as_ptr(), samples.as_mut_ptr(), &mut message)
        };
        if failed == 0 {
            Ok(samples)
        } else {
            let what = text(&message);
            Err(format!("not a readable picture: OpenImageIO says: {what}").into())
        }
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        // SAFETY: it was opened once, and nothing uses it from here on.
        unsafe { warpath_picture_close(self.picture.as_ptr()) }
    }
}

fn no_message() -> WarpathPictureMessage {
    WarpathPictureMessage { text: [0; 512] }
}

fn text(message: &WarpathPictureMessage) -> String {
    let bytes = message.text.map(c_char::cast_unsigned);
    let text = CStr::from_bytes_until_nul(&bytes).unwrap_or_default();
    // Several errors come as several lines: the first is the cause.
    let text = text.to_string_lossy();
    let first = text.lines().map(str::trim).find(|line| !line.is_empty());
    first.unwrap_or("it gives no reason").to_string()
}

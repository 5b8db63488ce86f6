//! What goes into a file: a text, or rows that are made while they are written,
//! so that a long table never stands in memory as text.

use std::borrow::Cow;
use std::io::{Result, Write};

/// What goes into a file.
pub trait Contents {
    /// Writes all of it.
    ///
    /// # Errors
    /// Those of `out`.
    fn write_to(&self, out: &mut dyn Write) -> Result<()>;

    /// All of it as text.
    fn text(&self) -> Cow<'_, str> {
        let mut bytes = Vec::new();
        // Writing to memory cannot fail.
        let _ = self.write_to(&mut bytes);
        Cow::Owned(String::from_utf8_lossy(&bytes).into_owned())
    }
}

impl Contents for String {
    fn write_to(&self, out: &mut dyn Write) -> Result<()> {
        out.write_all(self.as_bytes())
    }

    fn text(&self) -> Cow<'_, str> {
        Cow::Borrowed(self)
    }
}

impl Contents for Vec<u8> {
    fn write_to(&self, out: &mut dyn Write) -> Result<()> {
        out.write_all(self)
    }
}

/// Rows that `0` writes.
pub struct Rows<F>(pub F);

impl<F: Fn(&mut dyn Write) -> Result<()>> Contents for Rows<F> {
    fn write_to(&self, out: &mut dyn Write) -> Result<()> {
        (self.0)(out)
    }
}

impl Contents for Box<dyn Contents + '_> {
    fn write_to(&self, out: &mut dyn Write) -> Result<()> {
        (**self).write_to(out)
    }

    fn text(&self) -> Cow<'_, str> {
        (**self).text()
    }
}

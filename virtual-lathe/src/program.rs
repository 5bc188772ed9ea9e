//! Program text: where it comes from, and its lines one by one, as often as wanted, in bounded memory.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use feature_editor::codes::{Detector, Format};

/// Bytes of a line that are kept; what is beyond is counted in the line's length only.
const KEPT: usize = 1 << 24;

/// What some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Where a program's text comes from.
#[derive(Clone, Debug)]
pub enum Program {
    /// A file, read anew for each pass.
    File(PathBuf),
    /// Text in memory (the embedded demo, or standard input).
    Text {
        /// Its name in messages.
        name: String,
        /// The text.
        text: Vec<u8>,
    },
}

impl Program {
    /// Program of a path; `-` is standard input.
    ///
    /// # Errors
    /// Those of reading standard input, or of opening the file.
    pub fn open(path: &Path) -> io::Result<Self> {
        if path.as_os_str() == "-" {
            let mut text = Vec::new();
            io::stdin().lock().read_to_end(&mut text)?;
            return Ok(Self::Text { name: "stdin".into(), text });
        }
        let file = File::open(path)?;
        let kind = file.metadata()?;
        if kind.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder"));
        }
        if kind.is_file() {
            return Ok(Self::File(path.into()));
        }
        let mut text = Vec::new();
        BufReader::new(file).read_to_end(&mut text)?;
        Ok(Self::Text { name: path.display().to_string(), text })
    }

    /// The name shown in messages.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Text { name, .. } => name.clone(),
        }
    }

    /// The name that outputs get: without folder and extension.
    pub fn stem(&self) -> String {
        let name = self.name();
        Path::new(&name).file_stem().map_or_else(|| "program".into(), |stem| stem.to_string_lossy().into_owned())
    }

    /// Its size in bytes, for progress.
    pub fn size(&self) -> u64 {
        match self {
            Self::File(path) => std::fs::metadata(path).map_or(0, |data| data.len()),
            Self::Text { text, .. } => text.len() as u64,
        }
    }

    /// A fresh pass over its lines.
    ///
    /// # Errors
    /// Those of opening the file.
    pub fn lines(&self) -> io::Result<Lines> {
        let reader: Box<dyn BufRead> = match self {
            Self::File(path) => Box::new(BufReader::with_capacity(1 << 16, File::open(path)?)),
            Self::Text { text, .. } => Box::new(Cursor::new(text.clone())),
        };
        Ok(Lines { reader, line: Vec::new(), read: 0 })
    }

    /// The format, told by the whole text.
    ///
    /// # Errors
    /// Those of reading.
    pub fn detect(&self) -> io::Result<Format> {
        let mut detector = Detector::new();
        let mut lines = self.lines()?;
        while let Some(line) = lines.next_line()? {
            detector.line(line);
        }
        Ok(detector.format())
    }
}

/// One pass over the lines of a program.
pub struct Lines {
    reader: Box<dyn BufRead>,
    line: Vec<u8>,
    read: u64,
}

impl Lines {
    /// The next line without its line feed, or `None` at the end.
    ///
    /// # Errors
    /// Those of reading.
    pub fn next_line(&mut self) -> io::Result<Option<&[u8]>> {
        self.line.clear();
        let mut any = false;
        loop {
            let buffer = self.reader.fill_buf()?;
            if buffer.is_empty() {
                return Ok(any.then_some(&self.line));
            }
            any = true;
            let end = buffer.iter().position(|byte| *byte == b'\n');
            let take = end.unwrap_or(buffer.len());
            let first = self.read == 0;
            let room = KEPT.saturating_sub(self.line.len()).min(take);
            self.line.extend_from_slice(buffer.get(..room).unwrap_or_default());
            let used = end.map_or(take, |end| end + 1);
            self.reader.consume(used);
            self.read += used as u64;
            if first && self.line.starts_with(BYTE_ORDER_MARK) {
                self.line.drain(..BYTE_ORDER_MARK.len());
            }
            if end.is_some() {
                return Ok(Some(&self.line));
            }
        }
    }

    /// Bytes read so far.
    pub fn bytes(&self) -> u64 {
        self.read
    }
}

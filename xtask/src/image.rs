//! An image: its segments, sizes and symbols, and the files that programmers flash.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, bail};
use object::read::elf::{ElfFile32, FileHeader, ProgramHeader};
use object::{LittleEndian, Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind, elf};

use crate::graph::VECTORS;

/// Where RAM begins; what is loaded below is flash.
const RAM: u64 = 0x2000_0000;
/// Fills gaps, as erased flash does.
const ERASED: u8 = 0xFF;
/// Most bytes of a binary image: more means that segments lie far apart.
const MOST: u64 = 4 << 20;

/// A function of the image.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    /// Its names; identical functions share one body.
    pub(crate) names: Vec<String>,
    /// Bytes.
    pub(crate) size: u32,
}

/// Marks in the code: where instructions and where data begin.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// Instructions.
    Code,
    /// Constants.
    Data,
}

/// An image.
pub(crate) struct Image {
    /// What is loaded where: physical address and bytes.
    segments: Vec<(u64, Vec<u8>)>,
    /// Bytes at their run-time addresses: address, bytes, name.
    pub(crate) sections: Vec<(u32, Vec<u8>, String)>,
    /// Functions by address.
    pub(crate) functions: BTreeMap<u32, Function>,
    /// What begins where.
    pub(crate) contents: BTreeMap<u32, Content>,
    flash: u64,
    ram: u64,
}

impl Image {
    /// Reads an ELF file.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let bytes = fs::read(path).with_context(|| format!("reading {}", path.display()))?;
        let file = ElfFile32::<LittleEndian>::parse(&*bytes)?;
        let endian = LittleEndian;
        let mut segments = Vec::new();
        for header in file.elf_header().program_headers(endian, &*bytes)? {
            if header.p_type(endian) == elf::PT_LOAD
                && let Ok(data) = header.data(endian, &*bytes)
                && !data.is_empty()
            {
                segments.push((u64::from(header.p_paddr(endian)), data.to_vec()));
            }
        }
        segments.sort_by_key(|(address, _)| *address);
        let (mut ram, mut sections) = (0, Vec::new());
        for section in file.sections() {
            let at = u32::try_from(section.address())?;
            if at == 0 || section.size() == 0 {
                continue;
            }
            if section.address() >= RAM && section.kind() != SectionKind::Metadata {
                ram += section.size();
            }
            if let Ok(data) = section.data()
                && !data.is_empty()
            {
                sections.push((at, data.to_vec(), section.name()?.to_owned()));
            }
        }
        let (mut functions, mut contents) = (BTreeMap::new(), BTreeMap::new());
        for symbol in file.symbols() {
            let (name, at) = (symbol.name()?, u32::try_from(symbol.address())?);
            match name.as_bytes() {
                [b'$', b't' | b'a', ..] => drop(contents.insert(at & !1, Content::Code)),
                [b'$', b'd', ..] => drop(contents.insert(at, Content::Data)),
                _ => {}
            }
            if symbol.kind() == SymbolKind::Text && !name.starts_with('$') && !name.is_empty() {
                let size = u32::try_from(symbol.size())?;
                let function = functions.entry(at & !1).or_insert(Function { names: Vec::new(), size: 0 });
                function.size = function.size.max(size);
                function.names.push(name.to_owned());
            }
        }
        let flash = segments.iter().filter(|(at, _)| *at < RAM).map(|(_, data)| data.len() as u64).sum();
        Ok(Self { segments, sections, functions, contents, flash, ram })
    }

    /// Bytes of flash, and of RAM without stacks.
    pub(crate) const fn sizes(&self) -> (u64, u64) {
        (self.flash, self.ram)
    }

    /// The flash's content from its first byte on, gaps filled.
    pub(crate) fn binary(&self) -> Result<Vec<u8>> {
        let mut binary = Vec::new();
        let first = self.segments.first().context("the image is empty")?.0;
        for (address, data) in &self.segments {
            let offset = address - first;
            if offset > MOST {
                bail!("the image's parts lie too far apart for a binary file");
            }
            binary.resize(usize::try_from(offset)?.max(binary.len()), ERASED);
            binary.extend_from_slice(data);
        }
        Ok(binary)
    }

    /// The flash's content in Intel's hex format.
    pub(crate) fn hex(&self) -> Result<String> {
        let mut hex = String::new();
        let mut upper = None;
        for (address, data) in &self.segments {
            let mut at = u32::try_from(*address)?;
            let mut rest = data.as_slice();
            while !rest.is_empty() {
                // a record must not cross 64 KiB
                let room = usize::try_from(0x1_0000 - (at & 0xFFFF))?;
                let (record, later) = rest.split_at(rest.len().min(16).min(room));
                if upper != Some(at >> 16) {
                    upper = Some(at >> 16);
                    let [_, _, high, low] = (at >> 16).to_be_bytes();
                    hex_record(&mut hex, [0, 0], 4, &[high, low])?;
                }
                let [_, _, high, low] = at.to_be_bytes();
                hex_record(&mut hex, [high, low], 0, record)?;
                at += u32::try_from(record.len())?;
                rest = later;
            }
        }
        hex_record(&mut hex, [0, 0], 1, &[])?;
        Ok(hex)
    }

    /// Bytes at a run-time address.
    pub(crate) fn bytes(&self, at: u32, count: usize) -> Option<&[u8]> {
        self.sections.iter().find_map(|(start, data, _)| {
            let offset = usize::try_from(at.checked_sub(*start)?).ok()?;
            data.get(offset..offset.checked_add(count)?)
        })
    }

    /// Little-endian half word.
    pub(crate) fn half(&self, at: u32) -> Option<u16> {
        Some(u16::from_le_bytes(self.bytes(at, 2)?.try_into().ok()?))
    }

    /// Little-endian word.
    pub(crate) fn word(&self, at: u32) -> Option<u32> {
        Some(u32::from_le_bytes(self.bytes(at, 4)?.try_into().ok()?))
    }

    /// The number of the exception that a handler is for.
    pub(crate) fn vector(&self, handler: u32) -> Option<u32> {
        let (_, bytes, _) = self.sections.iter().find(|(_, _, name)| name == VECTORS)?;
        let words = bytes.chunks_exact(4).filter_map(|word| Some(u32::from_le_bytes(word.try_into().ok()?)));
        (0..).zip(words).find(|(_, word)| *word == handler | 1).map(|(number, _)| number)
    }

    /// Address of the function with this name.
    pub(crate) fn address(&self, name: &str) -> Option<u32> {
        self.functions.iter().find(|(_, function)| function.names.iter().any(|n| n == name)).map(|(at, _)| *at)
    }
}

fn hex_record(hex: &mut String, address: [u8; 2], kind: u8, data: &[u8]) -> Result<()> {
    let mut record = vec![u8::try_from(data.len())?, address[0], address[1], kind];
    record.extend_from_slice(data);
    let sum = record.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    record.push(sum.wrapping_neg());
    hex.push(':');
    for byte in record {
        write!(hex, "{byte:02X}")?;
    }
    hex.push('\n');
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_records_are_those_of_the_format_description() {
        let mut hex = String::new();
        hex_record(
            &mut hex,
            [0x01, 0x00],
            0,
            &[0x21, 0x46, 0x01, 0x36, 0x01, 0x21, 0x47, 0x01, 0x36, 0x00, 0x7E, 0xFE, 0x09, 0xD2, 0x19, 0x01],
        )
        .unwrap();
        hex_record(&mut hex, [0, 0], 1, &[]).unwrap();
        assert_eq!(hex, ":10010000214601360121470136007EFE09D2190140\n:00000001FF\n");
    }
}

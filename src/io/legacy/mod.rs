//! Legacy VTK files.

use std::io::{self, Write};
use super::dataset::DataSet;
use super::error::{Fault,Place};
use super::write::Objection;
pub(super) fn read(_bytes: &[u8]) -> Result<DataSet, Fault> { Err(Fault::unsupported(Place::File, "legacy", "XML")) }
pub(super) fn check(_d: &DataSet) -> Result<(), Objection> { Err(("legacy".into(), "XML".into())) }
pub(super) fn write(_d: &DataSet, _f: &mut impl Write) -> io::Result<()> { Ok(()) }

//! libigl's text matrices, `.dmat`.

use super::error::Fault;
use super::lexer::Lexer;

/// The numbers of a matrix, column after column.
///
/// The head says columns, then rows; the binary variant, with the head `0 0` and another one after it, is not read.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<f64>, Fault> {
    let mut lexer = Lexer::new(bytes);
    let columns: usize = lexer.number("a number of columns")?;
    let rows: usize = lexer.number("a number of rows")?;
    if columns == 0 && rows == 0 && !lexer.is_at_end() {
        return Err(Fault::unsupported(lexer.place(), "a binary .dmat file", "a text one"));
    }
    let count = columns.saturating_mul(rows);
    // A number takes two bytes at least.
    if count > lexer.remaining() {
        return Err(lexer.fault(format!("{columns} x {rows} numbers in {} bytes", lexer.remaining()), "as many as there are"));
    }
    (0..count).map(|_| lexer.number("a number")).collect()
}

//! Numbers and the bytes or words that stand for them.

use rayon::prelude::*;

/// How integers and floats are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}


/// A number with a fixed width in bytes.
pub(super) trait Element: Copy + Default + Send + Sync {
    const WIDTH: usize;

    /// The number in `WIDTH` bytes.
    fn of_bytes(bytes: &[u8], order: ByteOrder) -> Self;

    /// Appends the bytes of the number.
    fn push_bytes(self, order: ByteOrder, bytes: &mut Vec<u8>);
}

macro_rules! element {
    ($($number:ty),*) => {$(
        impl Element for $number {
            const WIDTH: usize = size_of::<$number>();

            #[inline]
            fn of_bytes(bytes: &[u8], order: ByteOrder) -> Self {
                let mut buffer = [0; size_of::<$number>()];
                buffer.copy_from_slice(bytes);
                match order {
                    ByteOrder::Little => Self::from_le_bytes(buffer),
                    ByteOrder::Big => Self::from_be_bytes(buffer),
                }
            }

            #[inline]
            fn push_bytes(self, order: ByteOrder, bytes: &mut Vec<u8>) {
                match order {
                    ByteOrder::Little => bytes.extend_from_slice(&self.to_le_bytes()),
                    ByteOrder::Big => bytes.extend_from_slice(&self.to_be_bytes()),
                }
            }
        }
    )*};
}
element!(i8, u8, i16, u16, i32, u32, i64, u64, f32, f64);

/// All numbers in `bytes`, whose length must be a multiple of the width. Long lists are converted in parallel.
pub(super) fn values_of_bytes<T: Element>(bytes: &[u8], order: ByteOrder) -> Vec<T> {
    /// Values of one task: enough to be worth it.
    const TASK: usize = 1 << 17;
    // Two loops, so that each is a plain copy or byte swap.
    fn convert<T: Element>(values: &mut [T], bytes: &[u8], order: ByteOrder) {
        let pairs = values.iter_mut().zip(bytes.chunks_exact(T::WIDTH));
        match order {
            ByteOrder::Little => pairs.for_each(|(value, bytes)| *value = T::of_bytes(bytes, ByteOrder::Little)),
            ByteOrder::Big => pairs.for_each(|(value, bytes)| *value = T::of_bytes(bytes, ByteOrder::Big)),
        }
    }
    let mut values = vec![T::default(); bytes.len() / T::WIDTH];
    if values.len() <= TASK {
        convert(&mut values, bytes, order);
    } else {
        let tasks = values.par_chunks_mut(TASK).zip(bytes.par_chunks(TASK * T::WIDTH));
        tasks.for_each(|(values, bytes)| convert(values, bytes, order));
    }
    values
}

/// The first `count` bits, highest bit of a byte first.
pub(super) fn unpack_bits(bytes: &[u8], count: usize) -> Vec<bool> {
    bytes.iter().flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1 == 1)).take(count).collect()
}

/// Bits as bytes, highest bit first, the last byte filled with zeros.
pub(super) fn pack_bits(bits: &[bool]) -> Vec<u8> {
    bits.chunks(8).map(|chunk| chunk.iter().enumerate().fold(0, |byte, (place, &bit)| byte | u8::from(bit) << (7 - place))).collect()
}

/// A number as C++ streams write it; they also write `nan(ind)` or `-nan`.
pub(super) fn parse_f64(token: &str) -> Option<f64> {
    token.parse().ok().or_else(|| is_nan(token).then_some(f64::NAN))
}

/// As [`parse_f64`], rounded once, to single precision.
pub(super) fn parse_f32(token: &str) -> Option<f32> {
    token.parse().ok().or_else(|| is_nan(token).then_some(f32::NAN))
}

fn is_nan(token: &str) -> bool {
    let token = token.trim_start_matches(['-', '+']).as_bytes();
    token.len() >= 4 && token[..4].eq_ignore_ascii_case(b"nan(")
}

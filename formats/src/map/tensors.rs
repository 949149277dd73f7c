//! Tensors as bytes: half floats, floats and counts, little-endian.

use half::f16;
use safetensors::Dtype;
use safetensors::tensor::{Metadata, TensorView};

use crate::error::FormatError;

/// A named tensor on its way to disk.
#[derive(Debug)]
pub(super) struct Tensor {
    name: &'static str,
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

/// The tensors of a file: their descriptions and the bytes that these point into.
#[derive(Debug)]
pub(super) struct Tensors<'a> {
    pub(super) metadata: Metadata,
    pub(super) bytes: &'a [u8],
}

impl Tensor {
    /// Half floats; finite values beyond ±65504 are clamped there, and every NaN becomes the same NaN.
    pub(super) fn f16(name: &'static str, shape: Vec<usize>, values: &[f32]) -> Self {
        let to_half = |&value: &f32| {
            let half = match value {
                v if v.is_nan() => f16::NAN,
                v if v.is_finite() => f16::from_f32(v.clamp(f16::MIN.to_f32(), f16::MAX.to_f32())),
                v => f16::from_f32(v),
            };
            half.to_le_bytes()
        };
        Self { name, dtype: Dtype::F16, shape, bytes: values.iter().flat_map(to_half).collect() }
    }

    pub(super) fn f32(name: &'static str, shape: Vec<usize>, values: impl Iterator<Item = f64>) -> Self {
        let bytes = values.flat_map(|value| (value as f32).to_le_bytes()).collect();
        Self { name, dtype: Dtype::F32, shape, bytes }
    }

    pub(super) fn u32(name: &'static str, values: impl Iterator<Item = u32>) -> Self {
        let bytes: Vec<u8> = values.flat_map(u32::to_le_bytes).collect();
        Self { name, dtype: Dtype::U32, shape: vec![bytes.len() / 4], bytes }
    }

    pub(super) fn name(&self) -> &'static str {
        self.name
    }

    pub(super) fn n_bytes(&self) -> usize {
        self.bytes.len()
    }

    pub(super) fn view(&self) -> Result<TensorView<'_>, FormatError> {
        TensorView::new(self.dtype, self.shape.clone(), &self.bytes)
            .map_err(|error| FormatError::malformed(format!("tensor {}: {error}", self.name), ""))
    }
}

impl Tensors<'_> {
    /// The half floats called `name`, if there are any; their shape must be `shape`.
    pub(super) fn f16(&self, name: &str, shape: &[usize]) -> Result<Option<Vec<f32>>, FormatError> {
        if self.metadata.info(name).is_none() {
            return Ok(None);
        }
        let elements = self.chunks::<2>(name, Dtype::F16, |found| found == shape)?;
        Ok(Some(elements.iter().map(|&half| f16::from_le_bytes(half).to_f32()).collect()))
    }

    /// The floats called `name`, all finite; `columns` a row, or a plain list where that is 1.
    pub(super) fn f32(&self, name: &str, columns: usize) -> Result<Vec<f64>, FormatError> {
        let is_expected = |found: &[usize]| match columns {
            1 => found.len() == 1,
            _ => found.len() == 2 && found[1] == columns,
        };
        let elements = self.chunks::<4>(name, Dtype::F32, is_expected)?;
        let values: Vec<f64> = elements.iter().map(|&float| f64::from(f32::from_le_bytes(float))).collect();
        if values.iter().all(|value| value.is_finite()) {
            Ok(values)
        } else {
            Err(unfit(format!("tensor {name} holds a value that is not finite")))
        }
    }

    /// The counts called `name`.
    pub(super) fn u32(&self, name: &str) -> Result<Vec<u32>, FormatError> {
        let elements = self.chunks::<4>(name, Dtype::U32, |found| found.len() == 1)?;
        Ok(elements.iter().map(|&count| u32::from_le_bytes(count)).collect())
    }

    /// The elements of the tensor called `name`, as bytes.
    fn chunks<const N: usize>(
        &self,
        name: &str,
        dtype: Dtype,
        is_expected: impl Fn(&[usize]) -> bool,
    ) -> Result<&[[u8; N]], FormatError> {
        let info = self.metadata.info(name).ok_or_else(|| unfit(format!("tensor {name} is missing")))?;
        if info.dtype != dtype || !is_expected(&info.shape) {
            return Err(unfit(format!("tensor {name} is {} {:?}", info.dtype, info.shape)));
        }
        let (start, end) = info.data_offsets;
        let bytes = self
            .bytes
            .get(start..end)
            .ok_or_else(|| unfit(format!("tensor {name} lies outside the file")))?;
        Ok(bytes.as_chunks().0)
    }
}

/// The error for tensors that do not fit together.
pub(super) fn unfit(message: String) -> FormatError {
    FormatError::malformed(message, "export the map anew")
}

//! Takes the place of [`super::level73`] in a build without the feature `hdf5`.

use super::variables::Variables;
use super::wanted::Wanted;
use crate::RecordingError;
use crate::source::Shared;

pub(super) fn variables(file: &str, _: &Shared, _: Wanted<'_>) -> Result<Variables, RecordingError> {
    let format = "HDF5 or MAT-files of level 7.3".to_owned();
    Err(RecordingError::LeftOut { file: file.into(), format, feature: "hdf5" })
}

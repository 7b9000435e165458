//! Prediction-error state-space models.

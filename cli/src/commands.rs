//! The commands.

pub mod demo;
pub mod evaluate;
pub mod import;
pub mod replay;
pub mod report;
pub mod reproduce;
pub mod simulate;
pub mod survey;
pub mod train;

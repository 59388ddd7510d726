//! Contact of deformable bodies with friction and heat.

pub mod contact;
pub mod element;
pub mod forms;
pub mod linalg;
pub mod space;
pub mod material;
pub mod mesh;
pub mod quadrature;
pub mod tensor;

pub mod field;
/// x
pub mod expression;
pub mod problem;
pub mod scheme;

//! Contact of deformable bodies with friction and heat.

pub mod case;
pub mod contact;
pub mod contract;
pub mod convergence;
pub mod element;
pub mod expression;
pub mod field;
pub mod forms;
pub mod hypotheses;
pub mod linalg;
pub mod material;
pub mod mesh;
pub mod output;
pub mod plot;
pub mod problem;
pub mod quadrature;
pub mod run;
pub mod scheme;
pub mod space;
pub mod tensor;
pub mod verify;

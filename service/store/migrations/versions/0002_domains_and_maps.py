"""Domains and maps with their versions, and which mission uses which."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Creates the tables; missions tell their fleet."""
    op.add_column("missions", sa.Column("fleet", sa.String(64)))
    op.create_table(
        "resources",
        sa.Column("kind", sa.String(10), primary_key=True),
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("version", sa.String(32), nullable=False),
        sa.Column("fleet", sa.String(64), nullable=False),
    )
    op.create_table(
        "resource_versions",
        sa.Column("kind", sa.String(10), primary_key=True),
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("version", sa.String(32), primary_key=True),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("created_by", sa.String(64), nullable=False),
        sa.Column("formulation", sa.String(64)),
        sa.Column("size_bytes", sa.Integer, nullable=False),
        sa.Column("body", sa.Text, nullable=False),
    )
    op.create_table(
        "mission_resources",
        sa.Column("mission_id", sa.String(40), sa.ForeignKey("missions.id"), primary_key=True),
        sa.Column("kind", sa.String(10), primary_key=True),
        sa.Column("name", sa.String(64), nullable=False),
        sa.Column("version", sa.String(32), nullable=False),
    )
    op.create_index("mission_resources_used", "mission_resources", ["kind", "name"])


def downgrade() -> None:
    """Drops the tables, and every uploaded domain and map."""
    for table in ("mission_resources", "resource_versions", "resources"):
        op.drop_table(table)
    op.drop_column("missions", "fleet")

"""The database: missions with their events, planning requests, domains and maps."""

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    DateTime,
    ForeignKey,
    Index,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    UniqueConstraint,
)

METADATA = MetaData()

MISSIONS = Table(
    "missions",
    METADATA,
    Column("id", String(40), primary_key=True),
    Column("name", String(200), nullable=False),
    Column("domain", String(64), nullable=False),
    Column("is_over", Boolean, nullable=False),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("idempotency_key", String(200), unique=True),
    Column("body_digest", String(64)),
    Column("fleet", String(64)),
    Index("missions_open", "is_over"),
)

EVENTS = Table(
    "events",
    METADATA,
    Column("id", BigInteger().with_variant(Integer, "sqlite"), primary_key=True),
    Column("mission_id", String(40), ForeignKey("missions.id"), nullable=False),
    Column("number", Integer, nullable=False),
    Column("kind", String(40), nullable=False),
    Column("recorded_at", DateTime(timezone=True), nullable=False),
    Column("body", Text, nullable=False),
    UniqueConstraint("mission_id", "number", name="one_event_a_number"),
)

PLAN_REQUESTS = Table(
    "plan_requests",
    METADATA,
    Column("id", String(40), primary_key=True),
    Column("client", String(64), nullable=False),
    Column("status", String(20), nullable=False),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("body", Text, nullable=False),
    Column("idempotency_key", String(200)),
    Column("body_digest", String(64)),
    Index("plan_requests_open", "status"),
    UniqueConstraint("client", "idempotency_key", name="one_request_a_key"),
)

PLAN_EVENTS = Table(
    "plan_events",
    METADATA,
    Column("request_id", String(40), ForeignKey("plan_requests.id"), primary_key=True),
    Column("number", Integer, primary_key=True),
    Column("body", Text, nullable=False),
)

RESOURCES = Table(
    "resources",
    METADATA,
    Column("kind", String(10), primary_key=True),
    Column("name", String(64), primary_key=True),
    Column("version", String(32), nullable=False),
    Column("fleet", String(64), nullable=False),
)

RESOURCE_VERSIONS = Table(
    "resource_versions",
    METADATA,
    Column("kind", String(10), primary_key=True),
    Column("name", String(64), primary_key=True),
    Column("version", String(32), primary_key=True),
    Column("number", Integer, nullable=False),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("created_by", String(64), nullable=False),
    Column("formulation", String(64)),
    Column("size_bytes", Integer, nullable=False),
    Column("body", Text, nullable=False),
)

MISSION_RESOURCES = Table(
    "mission_resources",
    METADATA,
    Column("mission_id", String(40), ForeignKey("missions.id"), primary_key=True),
    Column("kind", String(10), primary_key=True),
    Column("name", String(64), nullable=False),
    Column("version", String(32), nullable=False),
    Index("mission_resources_used", "kind", "name"),
)
